// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board/board_file.hpp"
#include "mebots/soc/device_kind.hpp"

#include <filesystem>
#include <memory>
#include <span>
#include <string>

namespace mebots::soc {

/// Opens a shared library that implements kinds of devices. The library stays open as long as this object exists.
class KindLibrary {
 public:
  /// Throws Error if the file cannot be opened, does not define device kinds, or was built for another version of
  /// MEbots.
  explicit KindLibrary(const std::filesystem::path& path);

  const std::filesystem::path& path() const { return path_; }
  std::span<const DeviceKind> kinds() const { return library_->kinds; }

 private:
  std::filesystem::path path_;
  std::shared_ptr<void> handle_;
  const DeviceLibrary* library_ = nullptr;
};

/// Returns the path of a library that the board names. Searches the folder of the board file first, and then `folders`
/// in their order. Throws Error if no folder contains the library.
std::filesystem::path kind_library_file(const BoardDescription& board, const std::string& name,
                                        std::span<const std::filesystem::path> folders);

}  // namespace mebots::soc
