// SPDX-License-Identifier: Apache-2.0
#include "instance.hpp"

#include <string>

namespace mebots::shell {
namespace {

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

}  // namespace

// Converts from UTF-8 explicitly, because the default encoding for narrow text in Windows depends on the machine.
// Removes the slash that a URI has before the drive letter: file:///C:/folder.
std::filesystem::path path_of_text(std::string_view utf8) {
  if (utf8.size() >= 3 && utf8[0] == '/' && is_letter(utf8[1]) && utf8[2] == ':') utf8.remove_prefix(1);
  return std::filesystem::path(std::u8string(utf8.begin(), utf8.end()));
}

}  // namespace mebots::shell
