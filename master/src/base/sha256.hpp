// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace mebots::master {

/// Returns the SHA-256 of the bytes as 64 hexadecimal digits.
std::string sha256(std::string_view bytes);
/// Returns the SHA-256 of a file as 64 hexadecimal digits. Throws InputError if the file cannot be read.
std::string sha256_of_file(const std::filesystem::path& file);

/// Computes SHA-256 values of a growing file and reads each byte only once.
class GrowingFileHash {
 public:
  GrowingFileHash();
  ~GrowingFileHash();
  GrowingFileHash(const GrowingFileHash&) = delete;
  GrowingFileHash& operator=(const GrowingFileHash&) = delete;

  /// Returns the SHA-256 of the first `bytes` bytes. `bytes` must not decrease between calls. The file may be renamed
  /// between calls. Throws InputError if the file is shorter.
  std::string up_to(const std::filesystem::path& file, std::uint64_t bytes);

 private:
  class Progress;

  std::unique_ptr<Progress> progress_;
  std::uint64_t bytes_ = 0;
};

}  // namespace mebots::master
