// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace mebots::master::ssp {

/// The files of an SSP, by their paths relative to the folder of its SSD.
class Files {
 public:
  virtual ~Files() = default;

  virtual bool holds(const std::filesystem::path& path) const = 0;
  /// Returns the bytes of the file at `path`. Throws InputError if the file does not exist.
  virtual std::string read(const std::filesystem::path& path) const = 0;
  /// Returns the path at which a reader of FMUs can open the file.
  virtual std::filesystem::path place(const std::filesystem::path& path) const = 0;
  /// Returns true if paths may lead out of the SSP. Paths of an archive must stay inside, because archives are not
  /// trusted.
  virtual bool is_open() const { return false; }
};

/// An SSP that is unpacked in a folder.
class FolderFiles final : public Files {
 public:
  /// If `is_open` is true, the user has unpacked the SSP, so `../` and absolute paths are allowed.
  FolderFiles(std::filesystem::path folder, bool is_open) : folder_(std::move(folder)), is_open_(is_open) {}

  bool holds(const std::filesystem::path& path) const override;
  std::string read(const std::filesystem::path& path) const override;
  std::filesystem::path place(const std::filesystem::path& path) const override {
    return (folder_ / path).lexically_normal();
  }
  bool is_open() const override { return is_open_; }
  /// Returns the bytes of all files read so far, in order.
  const std::string& bytes_read() const { return bytes_read_; }

 private:
  mutable std::string bytes_read_;
  std::filesystem::path folder_;
  bool is_open_;
};

/// A URI of a file (RFC 3986): a relative reference, or a URI of scheme `file`.
struct FileUri {
  std::filesystem::path path;
  bool has_backslashes = false;         ///< read as slashes
  std::optional<std::string> by_proxy;  ///< the host on which the FMU was meant to run
};

/// Accepts `proxyfmu://host?file=PATH` of the Open Simulation Platform, too, which refers to the file PATH. Returns
/// nullopt for all other schemes.
std::optional<FileUri> parse_file_uri(std::string_view uri);

}  // namespace mebots::master::ssp
