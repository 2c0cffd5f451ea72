// SPDX-License-Identifier: Apache-2.0
//
// Checks whether a path names a file or a folder. For an impossible path, such as a path that is too long,
// std::filesystem throws, but these functions return false. If access to a folder of the path is denied, is_there()
// returns true, because the file may exist.
#pragma once

#include <filesystem>
#include <system_error>

namespace mebots {

[[nodiscard]] inline bool is_there(const std::filesystem::path& path) noexcept {
  std::error_code failure;
  const auto type = std::filesystem::status(path, failure).type();
  if (type == std::filesystem::file_type::none) return failure == std::errc::permission_denied;
  return type != std::filesystem::file_type::not_found;
}

[[nodiscard]] inline bool is_file(const std::filesystem::path& path) noexcept {
  std::error_code failure;
  return std::filesystem::is_regular_file(path, failure);
}

[[nodiscard]] inline bool is_folder(const std::filesystem::path& path) noexcept {
  std::error_code failure;
  return std::filesystem::is_directory(path, failure);
}

}  // namespace mebots
