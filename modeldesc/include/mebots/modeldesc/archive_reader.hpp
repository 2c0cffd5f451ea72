// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/archive.hpp"

#include <functional>
#include <memory>
#include <optional>

struct zip;  // libzip's zip_t

namespace mebots::modeldesc {

struct DiscardZip {
  void operator()(zip* archive) const;
};
using ZipHandle = std::unique_ptr<zip, DiscardZip>;

/// Opens a zip archive for reading. If this fails, throws mebots::Error with the reason of libzip.
ZipHandle open_zip(const std::filesystem::path& archive);
/// Opens an archive in memory, which must outlive the handle. `name` is the archive's name in messages.
ZipHandle open_zip(std::string_view bytes, std::string_view name);

/// Normalises the name of an entry: removes parts that are empty or ".". Keeps the slash at the end of a folder's name.
/// Returns nullopt if a part is "..".
std::optional<std::string> normal_entry_name(std::string_view name);

/// Reads a zip archive. The constructor checks names, kinds and declared sizes of all entries.
class ArchiveReader {
 public:
  struct Entry {
    std::uint64_t index = 0;
    std::string name;        ///< with slashes; never a path outside of the destination folder
    std::uint64_t size = 0;  ///< unpacked bytes, as declared
    bool is_folder = false;
  };

  /// `name` is the archive's name in messages. Throws the same errors as unpack().
  ArchiveReader(ZipHandle archive, std::string name, const UnpackLimits& limits = {});

  const std::vector<Entry>& entries() const { return entries_; }
  /// Returns the number of entries whose names contain backslashes.
  std::size_t backslashes() const { return backslashes_; }
  /// Returns the number of entries that repeat the name and bytes of another entry. entries() omits them.
  std::size_t repeated() const { return repeated_; }
  /// Passes the entry's bytes to `take`, part by part. Throws mebots::Error if the bytes are damaged, or if their
  /// number differs from the declared size. Never passes more bytes than the declared size.
  void read(const Entry& entry, const std::function<void(std::string_view)>& take) const;

 private:
  [[noreturn]] void refuse(std::string_view name, std::string_view why) const;
  std::string checked_name(std::string_view name) const;
  void check_kind(const Entry& entry) const;
  void check_storage(const Entry& entry) const;
  bool is_same(const Entry& entry, const Entry& other) const;
  void check_size(const Entry& entry, std::uint64_t packed, std::uint64_t& total) const;

  ZipHandle archive_;
  std::string name_;
  UnpackLimits limits_;
  std::vector<Entry> entries_;
  std::size_t backslashes_ = 0;
  std::size_t repeated_ = 0;
};

}  // namespace mebots::modeldesc
