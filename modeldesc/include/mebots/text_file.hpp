// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/error.hpp"

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace mebots {

/// The whole content of a file or a pipe. Throws Error naming it and why it cannot be read; a device such as /dev/zero,
/// which may never end, is no file.
inline std::string text_of(const std::filesystem::path& path) {
  const auto refuse = [&](std::string_view why, ErrorCode code = ErrorCode::file_unreadable) {
    throw Error(code, path.string() + ": cannot be read: " + std::string(why));
  };
  std::error_code failure;
  const auto status = std::filesystem::status(path, failure);
  if (status.type() == std::filesystem::file_type::not_found)
    refuse("there is no such file", ErrorCode::file_not_found);
  if (std::filesystem::is_directory(status)) refuse("it is a folder");
  if (std::filesystem::is_character_file(status) || std::filesystem::is_block_file(status)) refuse("it is a device");
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) refuse(std::generic_category().message(errno));
  std::string text;
  std::vector<char> block(1 << 16);
  while (stream.read(block.data(), static_cast<std::streamsize>(block.size())) || stream.gcount() > 0) {
    text.append(block.data(), static_cast<std::size_t>(stream.gcount()));
  }
  if (stream.bad()) refuse("the device that it lies on reports an error");
  return text;
}

}  // namespace mebots
