// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/error.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace mebots::master {

/// Returns an error about a failed write to `path` with this errno. The text of the error states the remedy.
Error write_error(const std::filesystem::path& path, int error_number);

/// Renames a file on the same disk and replaces a file that has the new name. Throws InputError.
void rename_file(const std::filesystem::path& from, const std::filesystem::path& to);

/// Selects whether the replaced file must survive a power failure.
enum class Durable : bool { no, yes };

/// Writes the file PATH.new and renames it to PATH. If this fails, the file PATH is unchanged. Throws Error.
void write_whole(const std::filesystem::path& path, std::string_view content, Durable durable = Durable::no);

/// A file that is written in large pieces and that reports failed writes.
class OutputFile {
 public:
  enum class Mode {
    anew,    ///< creates or empties the file; follows a symbolic link, such as /dev/stdout
    fresh,   ///< creates the file; a file or link of this name is removed first, and never followed
    append,  ///< opens an existing file and appends to it
  };

  /// Throws InputError if the file cannot be opened.
  explicit OutputFile(std::filesystem::path path, Mode mode = Mode::anew);
  /// Writes the buffered bytes and ignores errors. To get errors, call close() first.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Returns the buffer of bytes to write. Append to it, then call written().
  std::string& buffer() { return buffer_; }
  /// Writes the buffer if it is large. Throws Error if the disk is full or fails.
  void written() {
    if (buffer_.size() >= kLargeBytes) flush();
  }
  void append(std::string_view bytes) {
    buffer_ += bytes;
    written();
  }
  /// Writes the buffer. Throws Error if the write fails. Drops the bytes that could not be written, so that the error
  /// is reported once.
  void flush();
  void close();
  /// Writes the buffer, and waits until all bytes are on the disk.
  void sync();

  /// Returns the number of bytes of the file, including the buffer.
  std::uint64_t size() const { return written_bytes_ + buffer_.size(); }
  /// Sets the length of the file, and drops all bytes after `size`. Throws Error.
  void truncate(std::uint64_t size);

  const std::filesystem::path& path() const { return path_; }
  /// Renames the file on the same disk and replaces a file that has the new name. Throws InputError.
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
