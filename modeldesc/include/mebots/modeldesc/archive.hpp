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

/// What unpack() takes at most; meant to stop decompression bombs, far above any honest FMU.
struct UnpackLimits {
  std::uint64_t total_bytes = std::uint64_t{4} << 30;
  std::uint64_t entries = 100'000;
  double ratio = 1000;  // unpacked / packed bytes of one entry larger than 16 MiB
};

/// Unpacks an FMU (a zip archive) into `folder`, which is made if missing. Throws mebots::Error naming archive
/// and entry for: a missing or damaged archive; an entry that would leave the folder (absolute, `..`, drive
/// letter, symbolic link), two entries of one name, or a limit passed. Nothing is written before all names
/// passed. A backslash in a name separates folders, as a slash does. Returns notices for the user: which names had one.
std::vector<std::string> unpack(const std::filesystem::path& archive, const std::filesystem::path& folder,
                                const UnpackLimits& limits = {});

/// Why an unpacked archive has no file `name` at its root, and what to do: the file is in a folder, or its name differs
/// in capitals. "It contains no `name`" if neither is so.
std::string why_missing(const std::filesystem::path& folder, const std::string& name);

/// One file of an archive to be: `entry` is its path inside, with forward slashes.
struct PackedFile {
  std::string entry;
  std::filesystem::path source;
};

/// Writes a zip archive: entries sorted by name, fixed times, so that the same files give the same bytes.
/// Throws mebots::Error for a missing file, two files for one entry, or an archive that cannot be written.
void pack(const std::filesystem::path& archive, std::vector<PackedFile> files);

/// A folder of unique name that goes, with all it holds, when this object goes.
class TemporaryFolder {
 public:
  /// Makes `<parent>/<prefix>-XXXXXX`; the system's folder for temporary files when `parent` is empty.
  explicit TemporaryFolder(std::string_view prefix, const std::filesystem::path& parent = {});
  /// Makes exactly this folder; nothing when it cannot be made, or is there already.
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
  pid_t owner_;  // a fork of the process leaves the folder alone
};

}  // namespace mebots::modeldesc
