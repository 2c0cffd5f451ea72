// SPDX-License-Identifier: Apache-2.0
#include "instance.hpp"

namespace mebots::shell {

std::filesystem::path path_of_text(std::string_view utf8) {
  return utf8;
}

}  // namespace mebots::shell
