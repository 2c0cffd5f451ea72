// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/system_description.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

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

  /// Of the first `bytes` bytes: at least as many as were asked for before. The file may have got another name since.
  /// Throws InputError when they are not there.
  std::string up_to(const std::filesystem::path& file, std::uint64_t bytes);

 private:
  class Progress;

  std::unique_ptr<Progress> progress_;
  std::uint64_t bytes_ = 0;
};

/// Fingerprint of all that a run depends on. The config's bytes, every FMU's bytes, the bytes of files that texts
/// among the parameters name (a program for a chip, say), those of files of signals, and what the command line changed.
struct InputHash {
  std::string all;
  std::string lines;  ///< what `all` is the hash of: one line per input, its own hash last
  std::string config;
  std::vector<std::pair<std::string, std::string>> fmus;  ///< instance, hash of its FMU
  std::vector<std::pair<std::string, std::string>>
      files;  ///< instance.parameter or the place of a signal, hash of the file
};

InputHash hash_inputs(const SystemDescription& system, std::span<const std::string> overrides);

}  // namespace mebots::master
