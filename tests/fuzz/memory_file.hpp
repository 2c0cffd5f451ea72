// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "require.hpp"

#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>

namespace mebots::fuzz {

/// A file in memory, for readers that need a path.
class MemoryFile {
 public:
  MemoryFile() : descriptor_(memfd_create("input", MFD_CLOEXEC)) { require(descriptor_ >= 0, "there is memory"); }
  ~MemoryFile() { close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  const std::filesystem::path& with(const std::uint8_t* data, std::size_t size) {
    const bool whole =
        ftruncate(descriptor_, 0) == 0 && pwrite(descriptor_, data, size, 0) == static_cast<ssize_t>(size);
    require(whole, "the input is in its file");
    return path_;
  }

 private:
  int descriptor_;
  std::filesystem::path path_ = fmt::format("/proc/self/fd/{}", descriptor_);
};

}  // namespace mebots::fuzz
