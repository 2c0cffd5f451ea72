// SPDX-License-Identifier: Apache-2.0
#include "run/folder_lock.hpp"

#include "mebots/input_error.hpp"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstring>
#include <string>
#include <thread>

namespace mebots::master {
namespace {

/// Whether the file of this name is still the one that was opened: its last owner removes it.
bool is_still(const std::filesystem::path& file, int descriptor) {
  struct stat named {};
  struct stat opened {};
  return ::stat(file.c_str(), &named) == 0 && ::fstat(descriptor, &opened) == 0 && named.st_ino == opened.st_ino &&
         named.st_dev == opened.st_dev;
}

std::string owner_of(int descriptor) {
  std::array<char, 32> text{};
  const auto size = ::pread(descriptor, text.data(), text.size(), 0);
  return size > 0 ? std::string(text.data(), static_cast<std::size_t>(size)) : "unknown";
}

/// Whether no process of this number is there. A process that a killed run was just starting keeps its lock for a
/// moment.
bool is_gone(const std::string& owner) {
  pid_t number = 0;
  const auto* const end = owner.data() + owner.size();
  if (std::from_chars(owner.data(), end, number).ptr != end || number <= 0) return false;
  return ::kill(number, 0) != 0 && errno == ESRCH;
}

constexpr std::chrono::milliseconds kWait{10};
constexpr int kMostWaits = 300;

}  // namespace

FolderLock::FolderLock(const std::filesystem::path& folder) : file_(folder / ".mebots.lock") {
  for (int waits = 0;;) {
    descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (descriptor_ < 0) {
      throw InputError(ErrorCode::file_unwritable,
                       fmt::format("{}: this file cannot be made: {}", file_.string(), std::strerror(errno)));
    }
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
      const auto owner = owner_of(descriptor_);
      ::close(descriptor_);
      if (is_gone(owner) && ++waits < kMostWaits) {
        std::this_thread::sleep_for(kWait);
        continue;
      }
      throw InputError(ErrorCode::file_unwritable,
                       fmt::format("{}: another run writes into this folder (process {}). Wait for its end, or choose "
                                   "another folder with --out",
                                   folder.string(), owner));
    }
    if (is_still(file_, descriptor_)) break;
    ::close(descriptor_);
  }
  // Should this fail, the lock holds all the same; only the other run's message lacks the number.
  const auto own = std::to_string(::getpid());
  static_cast<void>(::ftruncate(descriptor_, 0) == 0 && ::pwrite(descriptor_, own.data(), own.size(), 0) > 0);
}

FolderLock::~FolderLock() {
  std::error_code ignored;
  std::filesystem::remove(file_, ignored);  // before the lock goes: nobody may take a file that is then removed
  ::close(descriptor_);
}

}  // namespace mebots::master
