// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/error.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace mebots::master {

/// Describes a write to `path` that failed with this errno, and what to do about it.
Error write_error(const std::filesystem::path& path, int error_number);

/// Renames a file on the same disk, in the place of any file of the new name. Throws InputError.
void rename_file(const std::filesystem::path& from, const std::filesystem::path& to);

/// True if a file that is replaced must survive a power failure.
enum class Durable : bool { no, yes };

/// Writes PATH.new and renames it, so that the file is complete or as before. Throws Error.
void write_whole(const std::filesystem::path& path, std::string_view content, Durable durable = Durable::no);

/// A file that is written in large pieces and says so when a piece did not arrive.
class OutputFile {
 public:
  enum class Mode {
    anew,   ///< creates or empties the file; follows a symbolic link, such as /dev/stdout
    fresh,  ///< creates the file; a file or link of this name is removed first, and never followed
    go_on,  ///< opens an existing file, and writes at its end
  };

  /// Throws InputError when the file cannot be opened.
  explicit OutputFile(std::filesystem::path path, Mode mode = Mode::anew);
  /// Writes what is left, in silence: call close() to hear of a failure.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Where the next bytes go. Append freely, then call written().
  std::string& buffer() { return buffer_; }
  /// Hands the buffer on when it is large. Throws Error when the disk is full or broken.
  void written() {
    if (buffer_.size() >= kLargeBytes) flush();
  }
  void append(std::string_view bytes) {
    buffer_ += bytes;
    written();
  }
  /// Throws Error; what could not be written is dropped, so that it is complained about once.
  void flush();
  void close();
  /// Flushes, and waits until the bytes are on the disk.
  void sync();

  /// Bytes so far, those in the buffer included.
  std::uint64_t size() const { return written_bytes_ + buffer_.size(); }
  /// Cuts the file back (or, for a file that was written before, sets its length). Throws Error.
  void truncate(std::uint64_t size);

  const std::filesystem::path& path() const { return path_; }
  /// Gives the file another name, on the same disk, in the place of any file of that name. Throws InputError.
  void rename(std::filesystem::path path);

 private:
  static constexpr std::size_t kLargeBytes = 1 << 16;

  [[noreturn]] void fail(int error_number);

  std::filesystem::path path_;
  int descriptor_ = -1;
  std::string buffer_;
  std::uint64_t written_bytes_ = 0;
};

}  // namespace mebots::master
