// SPDX-License-Identifier: Apache-2.0
#include "record/sink/output_file.hpp"

#include "mebots/assert.hpp"
#include "mebots/input_error.hpp"

#include <fmt/format.h>

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace mebots::master {

Error write_error(const std::filesystem::path& path, int error_number) {
  const bool full = error_number == ENOSPC || error_number == EDQUOT;
  return {ErrorCode::file_unwritable,
          fmt::format("{}: writing failed: {}. {}", path.string(), std::strerror(error_number),
                      full ? "Free some space, or choose another folder with --out; fewer columns or a longer interval "
                             "under 'record' need less"
                           : "Choose another folder with --out")};
}

OutputFile::OutputFile(std::filesystem::path path, Mode mode) : path_(std::move(path)) {
  constexpr int kReadableByAll = 0644;
  const int how = mode == Mode::anew ? O_CREAT | O_TRUNC : 0;
  descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CLOEXEC | how, kReadableByAll);
  if (descriptor_ < 0) {
    throw InputError(ErrorCode::file_unwritable,
                     fmt::format("{}: the file cannot be written: {}. Choose another folder with --out", path_.string(),
                                 std::strerror(errno)));
  }
  if (mode == Mode::anew) return;
  const auto size = ::lseek(descriptor_, 0, SEEK_END);
  if (size > 0) written_bytes_ = static_cast<std::uint64_t>(size);
}

OutputFile::~OutputFile() {
  if (descriptor_ < 0) return;
  try {
    close();
  } catch (const Error&) {  // NOLINT(bugprone-empty-catch): whoever wants to know calls close()
  }
}

void OutputFile::flush() {
  MEBOTS_ASSERT(descriptor_ >= 0 || buffer_.empty(), "nothing is written after close()");
  const auto before = static_cast<off_t>(written_bytes_);
  std::string_view left = buffer_;
  while (!left.empty()) {
    const auto count = ::write(descriptor_, left.data(), left.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      const int error_number = errno;
      buffer_.clear();
      // Half a row would not be readable: back to where the last piece, which ended with a row, was whole.
      if (::ftruncate(descriptor_, before) == 0) written_bytes_ = static_cast<std::uint64_t>(before);
      fail(error_number);
    }
    left.remove_prefix(static_cast<std::size_t>(count));
    written_bytes_ += static_cast<std::uint64_t>(count);
  }
  buffer_.clear();
}

void OutputFile::sync() {
  flush();
  // A pipe or a device cannot be synchronised and need not be.
  if (::fdatasync(descriptor_) != 0 && errno != EINVAL && errno != EROFS) fail(errno);
}

void OutputFile::close() {
  if (descriptor_ < 0) return;
  try {
    flush();
  } catch (...) {
    ::close(descriptor_);
    descriptor_ = -1;
    throw;
  }
  const int status = ::close(descriptor_);
  descriptor_ = -1;
  if (status != 0) fail(errno);  // some file systems report a full disk only now
}

void OutputFile::rename(std::filesystem::path path) {
  std::error_code error;
  std::filesystem::rename(path_, path, error);
  if (error)
    throw InputError(ErrorCode::file_unwritable,
                     fmt::format("{}: the file cannot be replaced: {}", path.string(), error.message()));
  path_ = std::move(path);
}

void OutputFile::truncate(std::uint64_t size) {
  flush();
  const auto length = static_cast<off_t>(size);
  MEBOTS_ASSERT(descriptor_ >= 0);
  if (::ftruncate(descriptor_, length) != 0 || ::lseek(descriptor_, length, SEEK_SET) != length) fail(errno);
  written_bytes_ = size;
}

void OutputFile::fail(int error_number) {
  throw write_error(path_, error_number);
}

}  // namespace mebots::master
