// SPDX-License-Identifier: Apache-2.0
#include "slave/unpack_folder.hpp"

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

namespace mebots::master {
namespace {

constexpr const char* kPrefix = "mebots-fmu";
/// The owner holds a lock on this file, which the kernel takes back when it dies in whatever way.
constexpr const char* kOwnerFile = "owner";

int open_owner_file(const std::filesystem::path& file, int more_flags) {
  constexpr int kOwnerOnly = 0600;
  return ::open(file.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | more_flags, kOwnerOnly);
}

bool is_ours(const std::filesystem::path& folder) {
  struct stat info {};
  return ::lstat(folder.c_str(), &info) == 0 && S_ISDIR(info.st_mode) && info.st_uid == ::geteuid();
}

}  // namespace

UnpackFolder::UnpackFolder() : folder_(kPrefix) {
  static std::once_flag once;
  std::call_once(once, remove_abandoned_unpack_folders);
  // It gets its name when it is locked: nobody meets it without its lock.
  const auto owner = folder_.path() / kOwnerFile;
  const auto unlocked = folder_.path() / "new";
  lock_.file = open_owner_file(unlocked, O_CREAT);
  if (lock_.file < 0 || ::flock(lock_.file, LOCK_EX | LOCK_NB) != 0 || ::rename(unlocked.c_str(), owner.c_str()) != 0) {
    throw Error(ErrorCode::system_failure, fmt::format("{}: this folder for an unpacked FMU cannot be locked: {}",
                                                       folder_.path().string(), std::strerror(errno)));
  }
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
    // One without an owner's file is being made at this moment.
    const int file = open_owner_file(folder / kOwnerFile, 0);
    if (file < 0) continue;
    if (::flock(file, LOCK_EX | LOCK_NB) == 0) std::filesystem::remove_all(folder, error);
    ::close(file);
  }
}

}  // namespace mebots::master
