// SPDX-License-Identifier: Apache-2.0
#include "instance.hpp"

#include "mebots/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

namespace mebots::shell {
namespace {

[[noreturn]] void fail(std::string_view uri, std::string_view what) {
  throw Error(
      fmt::format("resource location \"{}\" {}; it must be a URI such as file:///tmp/unpacked/resources", uri, what));
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

bool starts_with_no_case(std::string_view text, std::string_view lower) {
  return text.size() >= lower.size() && std::equal(lower.begin(), lower.end(), text.begin(), [](char a, char b) {
           return a == (b >= 'A' && b <= 'Z' ? b - 'A' + 'a' : b);
         });
}

}  // namespace

std::filesystem::path path_of_file_uri(std::string_view uri) {
  if (uri.empty()) fail(uri, "is missing");
  if (!starts_with_no_case(uri, "file:")) fail(uri, "does not start with file:");
  std::string_view rest = uri.substr(5);
  if (rest.starts_with("//")) {
    rest.remove_prefix(2);
    if (starts_with_no_case(rest, "localhost/")) rest.remove_prefix(9);
    if (!rest.starts_with('/')) fail(uri, "names another machine or no absolute path");
  } else if (!rest.starts_with('/')) {
    fail(uri, "names no absolute path");
  }

  std::string path;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    if (rest[i] != '%') {
      path += rest[i];
      continue;
    }
    const int high = i + 2 < rest.size() ? hex_digit(rest[i + 1]) : -1;
    const int low = i + 2 < rest.size() ? hex_digit(rest[i + 2]) : -1;
    if (high < 0 || low < 0) fail(uri, "has a % without two hexadecimal digits");
    const char byte = static_cast<char>(high * 16 + low);
    if (byte == '\0') fail(uri, "contains a null byte");
    path += byte;
    i += 2;
  }
  while (path.size() > 1 && path.back() == '/') path.pop_back();
  return path_of_text(path);
}

}  // namespace mebots::shell
