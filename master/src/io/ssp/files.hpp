// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace mebots::master::ssp {

/// Reads the files of an SSP. Paths are relative to the folder of the SSD.
class Files {
 public:
  virtual ~Files() = default;

  virtual bool holds(const std::filesystem::path& path) const = 0;
  /// Returns the bytes of a file. Throws InputError if it does not exist.
  virtual std::string read(const std::filesystem::path& path) const = 0;
  /// Returns the path of a file for readers that need a path.
  virtual std::filesystem::path place(const std::filesystem::path& path) const = 0;
  /// True if paths may refer to files outside of the SSP. False for archives, which are not trusted.
  virtual bool is_open() const { return false; }
};

class FolderFiles final : public Files {
 public:
  /// If `is_open` is true, permits `../` and absolute paths. Must be true only if the user has unpacked the SSP.
  FolderFiles(std::filesystem::path folder, bool is_open) : folder_(std::move(folder)), is_open_(is_open) {}

  bool holds(const std::filesystem::path& path) const override;
  std::string read(const std::filesystem::path& path) const override;
  std::filesystem::path place(const std::filesystem::path& path) const override {
    return (folder_ / path).lexically_normal();
  }
  bool is_open() const override { return is_open_; }
  /// Returns the bytes of all files that were read, in the order of reading.
  const std::string& bytes_read() const { return bytes_read_; }

 private:
  mutable std::string bytes_read_;
  std::filesystem::path folder_;
  bool is_open_;
};

/// The file of a URI (RFC 3986) that is relative or has the scheme `file`.
struct FileUri {
  std::filesystem::path path;
  bool has_backslashes = false;         ///< true if the URI contained backslashes instead of slashes
  std::optional<std::string> by_proxy;  ///< the host that was to run the FMU; nullopt for an ordinary URI
};

/// Parses the URI of a file. Also accepts `proxyfmu://host?file=PATH` of the Open Simulation Platform. Returns nullopt
/// for all other schemes.
std::optional<FileUri> parse_file_uri(std::string_view uri);

}  // namespace mebots::master::ssp
