// SPDX-License-Identifier: Apache-2.0
#include "tool/host_files.hpp"

#include "mebots/error.hpp"

#include <fmt/core.h>

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string_view>
#include <system_error>

namespace mebots::soc::tool {
namespace {

constexpr std::string_view kConsole = ":tt";
/// File that lists the semihosting extensions of this host: exit with a code, and separate stdout and stderr.
constexpr std::string_view kFeatures = ":semihosting-features";
constexpr std::string_view kFeatureBytes = "SHFB\x03";
/// Maximum number of open files, because a program may forget to close them.
constexpr std::size_t kMostFiles = 256;

}  // namespace

HostFiles::HostFiles(const std::optional<std::string>& folder, Console& console) : console_(console) {
  if (!folder) return;
  std::error_code error;
  folder_ = std::filesystem::canonical(*folder, error);
  if (error || !std::filesystem::is_directory(*folder_, error)) {
    throw Error(fmt::format("--host-files {}: this is not a folder; make it first, or name another one", *folder));
  }
}

/// Returns the path of a file with all links resolved, or nullopt if the file is outside the folder.
std::optional<std::filesystem::path> HostFiles::inside(const std::string& name) const {
  if (!folder_ || name.empty()) return std::nullopt;
  std::error_code error;
  auto path = std::filesystem::weakly_canonical(*folder_ / name, error);
  if (error) return std::nullopt;
  const auto [end_of_folder, rest] = std::mismatch(folder_->begin(), folder_->end(), path.begin(), path.end());
  if (end_of_folder != folder_->end() || rest == path.end()) return std::nullopt;
  return path;
}

std::FILE* HostFiles::file_of(int file) const {
  const auto index = static_cast<std::size_t>(file) - kFirstFile;
  return file >= kFirstFile && index < files_.size() ? files_[index].get() : nullptr;
}

int HostFiles::open(const std::string& name, int flags) {
  const bool is_read = (flags & O_ACCMODE) == O_RDONLY;
  if (name == kConsole) return is_read || (flags & O_CREAT) == 0 ? 0 : (flags & O_APPEND) == 0 ? 1 : 2;
  if (name == kFeatures) {
    return is_read ? keep(::fmemopen(const_cast<char*>(kFeatureBytes.data()), kFeatureBytes.size(), "r")) : -EACCES;
  }
  const auto path = inside(name);
  if (!path) return -EACCES;
  std::error_code error;
  if (std::filesystem::is_directory(*path, error)) return -EISDIR;
  // The canonical path may still end with a link to a file that does not exist yet. O_NOFOLLOW refuses such a link,
  // because it may lead outside the folder.
  const int descriptor = ::open(path->c_str(), flags | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (descriptor < 0) return errno == ELOOP ? -EACCES : -errno;
  const auto* const mode = is_read ? "rb" : (flags & O_ACCMODE) == O_WRONLY ? "wb" : "r+b";
  auto* const file = ::fdopen(descriptor, mode);
  if (file == nullptr) ::close(descriptor);
  return keep(file);
}

/// Stores an open file and returns its number. If `file` is null, returns -errno.
int HostFiles::keep(std::FILE* file) {
  if (file == nullptr) return -errno;
  File kept(file);
  auto free = std::find(files_.begin(), files_.end(), nullptr);
  if (free == files_.end()) {
    if (files_.size() == kMostFiles) return -EMFILE;
    free = files_.emplace(free);
  }
  *free = std::move(kept);
  return static_cast<int>(free - files_.begin()) + kFirstFile;
}

int HostFiles::close(int file) {
  if (is_console(file)) return 0;
  if (file_of(file) == nullptr) return -EBADF;
  auto& held = files_[static_cast<std::size_t>(file - kFirstFile)];
  return std::fclose(held.release()) == 0 ? 0 : -EIO;
}

long HostFiles::read(int file, std::span<char> into) {
  if (is_console(file)) return console_.read(into);
  auto* held = file_of(file);
  if (held == nullptr) return -EBADF;
  std::fseek(held, 0, SEEK_CUR);  // C requires a seek between writing and reading
  const auto count = std::fread(into.data(), 1, into.size(), held);
  return count == 0 && std::ferror(held) != 0 ? (std::clearerr(held), -EIO) : static_cast<long>(count);
}

long HostFiles::write(int file, std::span<const char> bytes) {
  if (is_console(file) && file != kStandardError) {
    console_.write(bytes);
    return static_cast<long>(bytes.size());
  }
  auto* held = file == kStandardError ? stderr : file_of(file);
  if (held == nullptr) return -EBADF;
  if (!is_console(file)) std::fseek(held, 0, SEEK_CUR);
  const auto count = std::fwrite(bytes.data(), 1, bytes.size(), held);
  return count == 0 && !bytes.empty() ? -EIO : static_cast<long>(count);
}

long HostFiles::seek(int file, long offset, int origin) {
  auto* held = file_of(file);
  if (held == nullptr) return is_console(file) ? -ESPIPE : -EBADF;
  return std::fseek(held, offset, origin) == 0 ? std::ftell(held) : -EINVAL;
}

long HostFiles::length(int file) {
  if (is_console(file)) return 0;
  auto* held = file_of(file);
  if (held == nullptr) return -EBADF;
  const auto place = std::ftell(held);
  std::fseek(held, 0, SEEK_END);
  const auto length = std::ftell(held);
  std::fseek(held, place, SEEK_SET);
  return length;
}

int HostFiles::remove(const std::string& name) {
  const auto path = inside(name);
  if (!path) return -EACCES;
  return std::remove(path->c_str()) == 0 ? 0 : -errno;
}

int HostFiles::rename(const std::string& from, const std::string& to) {
  const auto old_path = inside(from);
  const auto new_path = inside(to);
  if (!old_path || !new_path) return -EACCES;
  return std::rename(old_path->c_str(), new_path->c_str()) == 0 ? 0 : -errno;
}

}  // namespace mebots::soc::tool
