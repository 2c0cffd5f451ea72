// SPDX-License-Identifier: Apache-2.0
#include "base/own_threads.hpp"

#include <sys/prctl.h>
#include <unistd.h>

#include <charconv>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <string>
#include <string_view>

namespace mebots::master {
namespace {

constexpr const char* kFamily = "mebots-server";  // a thread inherits the name of its creator

struct Known {
  std::mutex mutex;
  std::set<pid_t> threads;
  pid_t process = getpid();
};

Known& known() {
  static Known& all = *new Known;  // never destroyed, because threads may outlive main()
  return all;
}

bool is_of_family(const std::filesystem::path& task) {
  std::ifstream file(task / "comm");
  std::string name;
  return std::getline(file, name) && name == kFamily;
}

}  // namespace

OwnThread::OwnThread() {
  auto& all = known();
  const std::lock_guard lock(all.mutex);
  all.threads.insert(gettid());
}

OwnThread::~OwnThread() {
  auto& all = known();
  const std::lock_guard lock(all.mutex);
  all.threads.erase(gettid());
}

void mark_own_family() {
  prctl(PR_SET_NAME, kFamily);
}

void adopt_threads_of_fork() {
  auto& all = known();
  {
    const std::lock_guard lock(all.mutex);
    if (all.process == getpid()) return;
    all.process = getpid();
    all.threads.clear();
  }
  const auto now = foreign_threads();
  const std::lock_guard lock(all.mutex);
  all.threads.insert(now.begin(), now.end());
}

std::set<pid_t> foreign_threads() {
  std::set<pid_t> own;
  {
    auto& all = known();
    const std::lock_guard lock(all.mutex);
    own = all.threads;
  }
  std::set<pid_t> foreign;
  std::error_code problem;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task", problem)) {
    const auto name = entry.path().filename().string();
    pid_t number = 0;
    std::from_chars(name.data(), name.data() + name.size(), number);
    if (!own.contains(number) && !is_of_family(entry.path())) foreign.insert(number);
  }
  return foreign;
}

}  // namespace mebots::master
