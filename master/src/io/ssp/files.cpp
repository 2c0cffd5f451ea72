// SPDX-License-Identifier: Apache-2.0
#include "files.hpp"

#include "mebots/file_kind.hpp"
#include "mebots/input_error.hpp"

#include <fmt/format.h>

#include <fstream>
#include <iterator>

namespace mebots::master::ssp {

bool FolderFiles::holds(const std::filesystem::path& path) const {
  return is_file(folder_ / path);
}

std::string FolderFiles::read(const std::filesystem::path& path) const {
  std::ifstream stream(folder_ / path, std::ios::binary);
  if (!stream) throw InputError(ErrorCode::file_not_found, fmt::format("{}: the file is missing", path.string()));
  std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  bytes_read_ += bytes;
  return bytes;
}

}  // namespace mebots::master::ssp
