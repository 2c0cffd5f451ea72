// SPDX-License-Identifier: Apache-2.0
#include "write_text_file.hpp"

#include "mebots/error.hpp"

#include <fmt/format.h>

#include <fstream>

namespace mebots::modeldesc {

void write_text_file(const std::filesystem::path& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  stream << text;
  stream.close();
  if (!stream)
    throw Error(ErrorCode::file_unwritable,
                fmt::format("{}: cannot be written; check permissions and free space", file.string()));
}

}  // namespace mebots::modeldesc
