// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board/board_file.hpp"
#include "mebots/soc/device_kind.hpp"

#include <filesystem>
#include <memory>
#include <span>
#include <string>

namespace mebots::soc {

/// A shared library with kinds of devices, open as long as this lives.
class KindLibrary {
 public:
  /// Throws Error for a file that cannot be opened, is not such a library, or was made for another MEbots.
  explicit KindLibrary(const std::filesystem::path& path);

  const std::filesystem::path& path() const { return path_; }
  std::span<const DeviceKind> kinds() const { return library_->kinds; }

 private:
  std::filesystem::path path_;
  std::shared_ptr<void> handle_;
  const DeviceLibrary* library_ = nullptr;
};

/// One that a board names: beside the board's file, else in the first of the folders that has it. Throws Error.
KindLibrary find_kind_library(const BoardDescription& board, const std::string& name,
                              std::span<const std::filesystem::path> folders);

}  // namespace mebots::soc
