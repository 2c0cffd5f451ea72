// SPDX-License-Identifier: Apache-2.0
#include "devices/core/kind_library.hpp"

#include "devices/core/open_library.hpp"
#include "mebots/error.hpp"

#include <fmt/format.h>

#include <system_error>
#include <vector>

namespace mebots::soc {

KindLibrary::KindLibrary(const std::filesystem::path& path) : path_(path) {
  // If the path has no folder, the loader searches only the system's folders.
  const auto file = std::filesystem::absolute(path);
  handle_ = open_library(file);
  using Function = const DeviceLibrary* (*)();
  const auto function = reinterpret_cast<Function>(find_symbol(handle_.get(), "mebots_device_library"));
  if (function == nullptr) {
    throw Error(fmt::format("{}: this is not a library of devices: it lacks MEBOTS_DEVICE_KINDS", path.string()));
  }
  library_ = function();
  if (library_->interface != DeviceLibrary::kInterface || library_->entry_bytes != sizeof(BoardDevice)) {
    throw Error(
        fmt::format("{}: was built for another version of MEbots (interface {}, this one has {}); build it again",
                    path.string(), library_->interface, DeviceLibrary::kInterface));
  }
}

std::filesystem::path kind_library_file(const BoardDescription& board, const std::string& name,
                                        std::span<const std::filesystem::path> folders) {
  std::vector<std::filesystem::path> places = {board.folder / name};
  for (const auto& folder : folders) places.push_back(folder / name);
  std::string looked;
  for (const auto& place : places) {
    std::error_code error;
    if (std::filesystem::exists(place, error)) return place;
    looked += fmt::format("{}{}", looked.empty() ? "" : ", ", place.string());
  }
  throw Error(ErrorCode::file_not_found,
              fmt::format("board {}: its library {} was not found at {}", board.name, name, looked));
}

}  // namespace mebots::soc
