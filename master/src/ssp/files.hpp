// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <utility>

namespace mebots::master::ssp {

/// The files of an SSP, by their paths inside it.
class Files {
 public:
  virtual ~Files() = default;

  virtual bool holds(const std::filesystem::path& inside) const = 0;
  /// The file's bytes. Throws InputError for a file that is not there.
  virtual std::string read(const std::filesystem::path& inside) const = 0;
  /// Where the FMU reader finds the file.
  virtual std::filesystem::path place(const std::filesystem::path& inside) const = 0;
};

/// An SSP that is unpacked in a folder.
class FolderFiles final : public Files {
 public:
  explicit FolderFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}

  bool holds(const std::filesystem::path& inside) const override;
  std::string read(const std::filesystem::path& inside) const override;
  std::filesystem::path place(const std::filesystem::path& inside) const override { return folder_ / inside; }
  /// The bytes of all that was read so far, in that order.
  const std::string& bytes_read() const { return bytes_read_; }

 private:
  mutable std::string bytes_read_;
  std::filesystem::path folder_;
};

}  // namespace mebots::master::ssp
