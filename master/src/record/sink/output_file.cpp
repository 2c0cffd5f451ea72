// SPDX-License-Identifier: Apache-2.0
#include "record/sink/output_file.hpp"

#include "mebots/assert.hpp"
#include "mebots/input_error.hpp"

#include <fmt/format.h>

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

namespace mebots::master {
namespace {

/// Repeats a system call that a signal interrupts. Returns the last result.
template <typename Call>
auto uninterrupted(Call call) {
  auto result = call();
  while (result < 0 && errno == EINTR) result = call();
  return result;
}

/// Closes the descriptor. Returns false and sets errno after an error. After EINTR, Linux has also closed the
/// descriptor.
bool close_descriptor(int descriptor) {
  return ::close(descriptor) == 0 || errno == EINTR;
}

bool cannot_be_synced(int error_number) {
  return error_number == EINVAL || error_number == EROFS;  // pipes and devices do not support synchronisation
}

/// Synchronises a folder with the disk, so that a rename survives a power failure.
void sync_folder(const std::filesystem::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;  // without read permission, the folder cannot be synchronised
  const bool synced = uninterrupted([&] { return ::fsync(descriptor); }) == 0 || cannot_be_synced(errno);
  const int error_number = errno;
  ::close(descriptor);
  if (!synced) throw write_error(folder, error_number);
}

}  // namespace

Error write_error(const std::filesystem::path& path, int error_number) {
  const bool full = error_number == ENOSPC || error_number == EDQUOT;
  return {ErrorCode::file_unwritable,
          fmt::format("{}: writing failed: {}. {}", path.string(), std::strerror(error_number),
                      full ? "Free some space, or choose another folder with --out; fewer columns or a longer interval "
                             "under 'record' need less"
                           : "Choose another folder with --out")};
}

void rename_file(const std::filesystem::path& from, const std::filesystem::path& to) {
  if (uninterrupted([&] { return std::rename(from.c_str(), to.c_str()); }) == 0) return;
  throw InputError(ErrorCode::file_unwritable,
                   fmt::format("{}: the file cannot be replaced: {}", to.string(), std::strerror(errno)));
}

void write_whole(const std::filesystem::path& path, std::string_view content, Durable durable) {
  const std::filesystem::path unfinished = path.string() + ".new";
  OutputFile file(unfinished, OutputFile::Mode::fresh);
  try {
    file.append(content);
    if (durable == Durable::yes) file.sync();
    file.close();
    file.rename(path);
  } catch (const Error&) {
    std::error_code ignored;
    std::filesystem::remove(unfinished, ignored);
    throw;
  }
  if (durable == Durable::yes) sync_folder(path.parent_path().empty() ? "." : path.parent_path());
}

OutputFile::OutputFile(std::filesystem::path path, Mode mode) : path_(std::move(path)) {
  constexpr int kReadableByAll = 0644;
  constexpr int kHow[] = {O_CREAT | O_TRUNC, O_CREAT | O_EXCL | O_NOFOLLOW, 0};  // indexed by Mode
  const int how = kHow[static_cast<std::size_t>(mode)];
  if (mode == Mode::fresh) ::unlink(path_.c_str());  // if this fails, open() reports the error
  descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CLOEXEC | how, kReadableByAll);
  if (descriptor_ < 0) {
    throw InputError(ErrorCode::file_unwritable,
                     fmt::format("{}: the file cannot be written: {}. Choose another folder with --out", path_.string(),
                                 std::strerror(errno)));
  }
  if (mode != Mode::append) return;
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
      // Removes the incomplete last row, which other programs could not read.
      if (uninterrupted([&] { return ::ftruncate(descriptor_, before); }) == 0)
        written_bytes_ = static_cast<std::uint64_t>(before);
      fail(error_number);
    }
    left.remove_prefix(static_cast<std::size_t>(count));
    written_bytes_ += static_cast<std::uint64_t>(count);
  }
  buffer_.clear();
}

void OutputFile::sync() {
  flush();
  if (uninterrupted([&] { return ::fdatasync(descriptor_); }) != 0 && !cannot_be_synced(errno)) fail(errno);
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
  // Some file systems report a full disk only at close().
  if (!close_descriptor(std::exchange(descriptor_, -1))) fail(errno);
}

void OutputFile::rename(std::filesystem::path path) {
  rename_file(path_, path);
  path_ = std::move(path);
}

void OutputFile::truncate(std::uint64_t size) {
  flush();
  const auto length = static_cast<off_t>(size);
  MEBOTS_ASSERT(descriptor_ >= 0);
  if (uninterrupted([&] { return ::ftruncate(descriptor_, length); }) != 0 ||
      ::lseek(descriptor_, length, SEEK_SET) != length)
    fail(errno);
  written_bytes_ = size;
}

void OutputFile::fail(int error_number) {
  throw write_error(path_, error_number);
}

}  // namespace mebots::master
