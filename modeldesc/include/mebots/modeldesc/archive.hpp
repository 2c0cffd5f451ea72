// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::modeldesc {

/// Limits of unpack() against decompression bombs. Real FMUs are far smaller.
struct UnpackLimits {
  std::uint64_t total_bytes = std::uint64_t{4} << 30;
  std::uint64_t entries = 100'000;
  double ratio = 1000;  // unpacked / packed bytes, for entries larger than 16 MiB
};

/// Unpacks an FMU (a zip archive) into `folder`, which is created if necessary. Throws mebots::Error with archive and
/// entry if the archive is missing or damaged, two entries have the same name and different bytes, or a limit is
/// exceeded. Also throws if an entry would be written outside of the folder (absolute path, `..`, drive letter,
/// symbolic link). Checks all names before the first write. Treats a backslash in a name as a slash. Returns notices
/// for the user about backslashes and repeated entries.
std::vector<std::string> unpack(const std::filesystem::path& archive, const std::filesystem::path& folder,
                                const UnpackLimits& limits = {});

/// Explains why an unpacked archive has no file `name` at its root, and how to correct this. For example, the file is
/// in a folder, or its name differs in case. If no reason is found, returns "it contains no `name`".
std::string why_missing(const std::filesystem::path& folder, const std::string& name);

/// A file to pack: `entry` is its path in the archive, with forward slashes.
struct PackedFile {
  std::string entry;
  std::filesystem::path source;
};

/// Writes a zip archive. Equal files give equal archives: entries are sorted and have fixed times. Throws mebots::Error
/// if a file is missing, two files have the same entry, or the archive cannot be written.
void pack(const std::filesystem::path& archive, std::vector<PackedFile> files);

/// A temporary folder with a unique name. The destructor deletes the folder with its contents.
class TemporaryFolder {
 public:
  /// Creates `<parent>/<prefix>-XXXXXX`. If `parent` is empty, uses the system's folder for temporary files.
  explicit TemporaryFolder(std::string_view prefix, const std::filesystem::path& parent = {});
  /// Creates the folder `path`. Returns empty if the folder already exists or cannot be created.
  static std::optional<TemporaryFolder> at(std::filesystem::path path);
  ~TemporaryFolder();
  TemporaryFolder(TemporaryFolder&& other) noexcept;
  TemporaryFolder& operator=(TemporaryFolder&& other) noexcept;
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  TemporaryFolder();
  void remove() noexcept;
  std::filesystem::path path_;
  pid_t owner_;  // only this process deletes the folder, not its forks
};

}  // namespace mebots::modeldesc
