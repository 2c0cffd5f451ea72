// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/error.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace mebots::master {

/// Returns an Error for a failed write to `path`. The text contains the reason for `error_number` (an errno) and the
/// remedy.
Error write_error(const std::filesystem::path& path, int error_number);

/// Renames a file on the same disk and replaces an existing file. Throws InputError if this fails.
void rename_file(const std::filesystem::path& from, const std::filesystem::path& to);

/// States whether a file must survive a power failure.
enum class Durable : bool { no, yes };

/// Writes PATH.new and renames it to PATH. If this fails, throws Error and leaves PATH unchanged.
void write_whole(const std::filesystem::path& path, std::string_view content, Durable durable = Durable::no);

/// A buffered file. Functions throw Error if a write fails.
class OutputFile {
 public:
  enum class Mode {
    anew,    ///< creates or truncates the file; follows a symbolic link, such as /dev/stdout
    fresh,   ///< removes a file or link of this name, then creates the file; never follows a link
    append,  ///< opens an existing file for appending
  };

  /// Throws InputError if the file cannot be opened.
  explicit OutputFile(std::filesystem::path path, Mode mode = Mode::anew);
  /// Writes the buffer and ignores errors. To receive errors, call close() first.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Returns the buffer for appending bytes. Call written() afterwards.
  std::string& buffer() { return buffer_; }
  /// Writes the buffer to the file if it is large. Throws Error if this fails.
  void written() {
    if (buffer_.size() >= kLargeBytes) flush();
  }
  void append(std::string_view bytes) {
    buffer_ += bytes;
    written();
  }
  /// Writes the buffer to the file. If this fails, drops the buffer and throws Error, so that the error occurs only
  /// once.
  void flush();
  void close();
  /// Writes the buffer and waits until all bytes are on the disk.
  void sync();

  /// Returns the size of the file in bytes, including the buffer.
  std::uint64_t size() const { return written_bytes_ + buffer_.size(); }
  /// Shortens the file to `size` bytes. Throws Error if this fails.
  void truncate(std::uint64_t size);

  const std::filesystem::path& path() const { return path_; }
  /// Renames the file on the same disk and replaces an existing file. Throws InputError if this fails.
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
