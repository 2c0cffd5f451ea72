// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace mebots::master::ssp {

/// Gives access to the files of an SSP. Their paths are relative to the folder of the SSD.
class Files {
 public:
  virtual ~Files() = default;

  virtual bool holds(const std::filesystem::path& path) const = 0;
  /// Returns the bytes of the file at `path`. Throws InputError if the file does not exist.
  virtual std::string read(const std::filesystem::path& path) const = 0;
  /// Returns a path at which a reader of FMUs can open the file.
  virtual std::filesystem::path place(const std::filesystem::path& path) const = 0;
  /// Returns true if paths may refer to files outside of the SSP. An archive is not trusted, so that its paths must
  /// stay inside the archive.
  virtual bool is_open() const { return false; }
};

/// Gives access to an SSP that is unpacked in a folder.
class FolderFiles final : public Files {
 public:
  /// `is_open` permits `../` and absolute paths. It must be true only if the user has unpacked the SSP.
  FolderFiles(std::filesystem::path folder, bool is_open) : folder_(std::move(folder)), is_open_(is_open) {}

  bool holds(const std::filesystem::path& path) const override;
  std::string read(const std::filesystem::path& path) const override;
  std::filesystem::path place(const std::filesystem::path& path) const override {
    return (folder_ / path).lexically_normal();
  }
  bool is_open() const override { return is_open_; }
  /// Returns the bytes of all files that were read so far, in the order of reading.
  const std::string& bytes_read() const { return bytes_read_; }

 private:
  mutable std::string bytes_read_;
  std::filesystem::path folder_;
  bool is_open_;
};

/// The file to which a URI (RFC 3986) refers. The URI is a relative reference, or its scheme is `file`.
struct FileUri {
  std::filesystem::path path;
  bool has_backslashes = false;         ///< true if the URI contained backslashes, which were read as slashes
  std::optional<std::string> by_proxy;  ///< the host on which the FMU was intended to run; nullopt for an ordinary URI
};

/// Parses a URI of a file. Also accepts `proxyfmu://host?file=PATH` of the Open Simulation Platform, which refers to
/// the file PATH. Returns nullopt for all other schemes.
std::optional<FileUri> parse_file_uri(std::string_view uri);

}  // namespace mebots::master::ssp
