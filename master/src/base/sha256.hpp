// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace mebots::master {

/// SHA-256 as 64 hexadecimal digits.
std::string sha256(std::string_view bytes);
/// Throws InputError when the file cannot be read.
std::string sha256_of_file(const std::filesystem::path& file);

/// SHA-256 of the first bytes of a file that grows; reads no byte twice.
class GrowingFileHash {
 public:
  GrowingFileHash();
  ~GrowingFileHash();
  GrowingFileHash(const GrowingFileHash&) = delete;
  GrowingFileHash& operator=(const GrowingFileHash&) = delete;

  /// Of the first `bytes` bytes: at least as many as in the call before. The file may have got another name since.
  /// Throws InputError when they are not there.
  std::string up_to(const std::filesystem::path& file, std::uint64_t bytes);

 private:
  class Progress;

  std::unique_ptr<Progress> progress_;
  std::uint64_t bytes_ = 0;
};

}  // namespace mebots::master
