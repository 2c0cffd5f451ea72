// SPDX-License-Identifier: Apache-2.0
#include "fmi/unpack_folder.hpp"

#include "mebots/error.hpp"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace mebots::master {
namespace {

constexpr const char* kPrefix = "mebots-fmu";
/// A file in the folder that the owning process locks. The kernel releases the lock when this process ends in any way.
constexpr const char* kOwnerFile = "owner";

int open_owner_file(const std::filesystem::path& file, int more_flags) {
  constexpr int kOwnerOnly = 0600;
  return ::open(file.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | more_flags, kOwnerOnly);
}

bool is_ours(const std::filesystem::path& folder) {
  struct stat info {};
  return ::lstat(folder.c_str(), &info) == 0 && S_ISDIR(info.st_mode) && info.st_uid == ::geteuid();
}

struct Paths {
  std::mutex mutex;
  std::vector<std::filesystem::path> paths;
};

/// Returns the paths that UnpackFolder::release_path() has stored for later folders of this process.
Paths& free_paths() {
  static Paths& all = *new Paths;  // never destroyed, because an FMU may be closed at the end of the process
  return all;
}

modeldesc::TemporaryFolder make_folder() {
  auto& free = free_paths();
  std::filesystem::path path;
  {
    const std::lock_guard lock(free.mutex);
    if (!free.paths.empty()) {
      path = std::move(free.paths.back());
      free.paths.pop_back();
    }
  }
  // The path is unusable if TMPDIR has changed, or if another process has created a folder with this name.
  std::error_code error;
  if (!path.empty() && path.parent_path() == std::filesystem::temp_directory_path(error)) {
    if (auto folder = modeldesc::TemporaryFolder::at(path)) return std::move(*folder);
  }
  return modeldesc::TemporaryFolder(kPrefix);
}

}  // namespace

UnpackFolder::UnpackFolder() : folder_(make_folder()) {
  static std::once_flag once;
  std::call_once(once, remove_abandoned_unpack_folders);
  // The file receives its final name after it is locked. Other processes therefore never find an unlocked owner file.
  const auto owner = folder_.path() / kOwnerFile;
  const auto unlocked = folder_.path() / "new";
  lock_.file = open_owner_file(unlocked, O_CREAT);
  if (lock_.file < 0 || ::flock(lock_.file, LOCK_EX | LOCK_NB) != 0 || ::rename(unlocked.c_str(), owner.c_str()) != 0) {
    throw Error(ErrorCode::system_failure, fmt::format("{}: this folder for an unpacked FMU cannot be locked: {}",
                                                       folder_.path().string(), std::strerror(errno)));
  }
}

void UnpackFolder::release_path() {
  auto& free = free_paths();
  const std::lock_guard lock(free.mutex);
  free.paths.push_back(folder_.path());
}

UnpackFolder::Lock::~Lock() {
  if (file >= 0) ::close(file);
}

void remove_abandoned_unpack_folders() {
  std::error_code error;
  const auto parent = std::filesystem::temp_directory_path(error);
  if (error) return;
  for (const auto& entry : std::filesystem::directory_iterator(parent, error)) {
    const auto& folder = entry.path();
    if (!folder.filename().string().starts_with(std::string(kPrefix) + "-") || !is_ours(folder)) continue;
    // If the folder has no owner file, another process is creating the folder.
    const int file = open_owner_file(folder / kOwnerFile, 0);
    if (file < 0) continue;
    if (::flock(file, LOCK_EX | LOCK_NB) == 0) std::filesystem::remove_all(folder, error);
    ::close(file);
  }
}

}  // namespace mebots::master
