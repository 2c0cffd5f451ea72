// SPDX-License-Identifier: Apache-2.0
#include "run/result_folder.hpp"

#include "mebots/input_error.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstring>
#include <string>
#include <thread>

namespace mebots::master {
ResultFolder::ResultFolder(std::filesystem::path path) : path_(std::move(path)) {
  std::error_code error;
  for (auto folder = path_; !folder.empty() && !std::filesystem::exists(folder, error); folder = folder.parent_path()) {
    made_.push_back(folder);
  }
  std::filesystem::create_directories(path_, error);
  if (error || !std::filesystem::is_directory(path_)) {
    throw InputError(ErrorCode::file_unwritable,
                     fmt::format("{}: the results folder cannot be created: {}. Choose another one with --out",
                                 path_.string(), error ? error.message() : "there is a file of this name"));
  }
  lock_.emplace(path_);
}

ResultFolder::~ResultFolder() {
  std::error_code ignored;
  for (const auto& waiting : waiting_) std::filesystem::remove(waiting.now, ignored);
  if (kept_) return;
  lock_.reset();  // removes the lock file, so that the folder can be removed
  for (const auto& folder : made_) std::filesystem::remove(folder, ignored);  // removes only empty folders
}

OutputFile& ResultFolder::create(std::string_view name) {
  auto& file = files_.emplace_back(reserve(name), OutputFile::Mode::fresh);
  waiting_.back().file = &file;
  return file;
}

std::filesystem::path ResultFolder::reserve(std::string_view name) {
  const auto later = path_ / name;
  waiting_.push_back({later.string() + ".new", later, nullptr});
  return waiting_.back().now;
}

OutputFile& ResultFolder::reopen(std::string_view name) {
  return files_.emplace_back(path_ / name, OutputFile::Mode::append);
}

void ResultFolder::keep(std::span<const std::string_view> outdated) {
  kept_ = true;
  std::error_code error;
  for (const auto name : outdated) {
    const auto replaced = [&](const Waiting& waiting) { return waiting.later == path_ / name; };
    if (std::any_of(waiting_.begin(), waiting_.end(), replaced)) continue;
    std::filesystem::remove(path_ / name, error);
    if (error) {
      throw InputError(ErrorCode::file_unwritable, fmt::format("{}: this file of an earlier run cannot be removed: {}",
                                                               (path_ / name).string(), error.message()));
    }
  }
  for (const auto& [now, later, file] : waiting_) {
    if (file != nullptr) {
      file->rename(later);
    } else {
      rename_file(now, later);
    }
  }
  waiting_.clear();
}

namespace {

/// True if this path still refers to the opened lock file. Another run may have removed the file.
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

/// True if no process has the number `owner`. The lock of a killed run may remain for a moment, because its child
/// process also holds it.
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
                       fmt::format("{}: this file cannot be created: {}", file_.string(), std::strerror(errno)));
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
  // Stores the process number in the locked file. If another run tries to lock the folder, its error contains this
  // number. If writing fails, the lock is still valid.
  const auto own = std::to_string(::getpid());
  static_cast<void>(::ftruncate(descriptor_, 0) == 0 && ::pwrite(descriptor_, own.data(), own.size(), 0) > 0);
}

FolderLock::~FolderLock() {
  std::error_code ignored;
  // The file must be removed before it is unlocked. Otherwise, another run could lock the file that is then removed.
  std::filesystem::remove(file_, ignored);
  ::close(descriptor_);
}

}  // namespace mebots::master
