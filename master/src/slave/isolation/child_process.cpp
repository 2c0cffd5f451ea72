// SPDX-License-Identifier: Apache-2.0
#include "child_process.hpp"

#include "base/installation.hpp"

#include "mebots/error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <thread>

namespace mebots::master::isolation {
namespace {

struct SpawnSettings {
  posix_spawn_file_actions_t actions{};
  posix_spawnattr_t attributes{};

  SpawnSettings() {
    posix_spawn_file_actions_init(&actions);
    posix_spawnattr_init(&attributes);
  }
  ~SpawnSettings() {
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
  }
  SpawnSettings(const SpawnSettings&) = delete;
  SpawnSettings& operator=(const SpawnSettings&) = delete;
};

std::size_t open_descriptors() {
  std::error_code ignored;
  const std::filesystem::directory_iterator entries("/proc/self/fd", ignored);
  return static_cast<std::size_t>(std::distance(begin(entries), end(entries)));
}

}  // namespace

void reserve_descriptors(std::size_t count, std::size_t each) {
  if (count == 0) return;
  // Number of descriptors for other purposes: for result files, for a process during its start, and for files of the C
  // library.
  constexpr std::size_t kOthers = 32;
  const auto open = open_descriptors();
  const rlim_t needed = open + count * each + kOthers;
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= needed) return;
  const rlimit raised{needed, limit.rlim_max};
  if (needed <= limit.rlim_max && setrlimit(RLIMIT_NOFILE, &raised) == 0) return;
  throw Error(
      ErrorCode::system_failure,
      fmt::format("{} isolated instances need {} open files ({} each, {} are open, {} for others), and the hard "
                  "limit is {}. Raise it (`ulimit -Hn {}`), or isolate fewer instances",
                  count, needed, each, open, kOthers, limit.rlim_max, needed));
}

ChildProcess::ChildProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                           const std::array<int, 4>& descriptors) {
  SpawnSettings settings;
  posix_spawn_file_actions_addopen(&settings.actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  int target = STDERR_FILENO + 1;
  for (const int descriptor : descriptors) {
    posix_spawn_file_actions_adddup2(&settings.actions, descriptor, target++);
  }
  posix_spawn_file_actions_addclosefrom_np(&settings.actions, target);
  sigset_t none;
  sigset_t all;
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawnattr_setsigmask(&settings.attributes, &none);
  posix_spawnattr_setsigdefault(&settings.attributes, &all);
  posix_spawnattr_setflags(&settings.attributes, POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  std::vector<std::string> words = arguments;
  words.insert(words.begin(), program.string());
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (auto& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const int error =
      posix_spawn(&pid_, program.c_str(), &settings.actions, &settings.attributes, pointers.data(), environ);
  if (error != 0) {
    throw Error(ErrorCode::system_failure,
                fmt::format("{}: this program cannot be started: {}", program.string(), std::strerror(error)));
  }
}

ChildProcess::~ChildProcess() {
  kill();
}

std::optional<ProcessEnd> ChildProcess::ended() {
  if (end_) return end_;
  int status = 0;
  rusage usage{};  // includes the processes of the keeper
  pid_t one = 0;
  while ((one = wait4(pid_, &status, WNOHANG, &usage)) < 0 && errno == EINTR) {
  }
  if (one == 0) return std::nullopt;
  if (one < 0) {
    end_ = ProcessEnd{};  // another thread has reaped the process; the cause of its end is unknown
    return end_;
  }
  const bool by_signal = WIFSIGNALED(status);
  end_ = ProcessEnd{by_signal, by_signal ? WTERMSIG(status) : WEXITSTATUS(status), usage.ru_maxrss};
  return end_;
}

std::optional<ProcessEnd> ChildProcess::ended_within(double seconds) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!ended() && std::chrono::steady_clock::now() < until) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return end_;
}

void ChildProcess::kill() {
  if (ended()) return;
  end_kept(pid_);
  ended();
}

std::string signal_text(int signal) {
  const auto* name = sigabbrev_np(signal);
  const auto* meaning = [&] {
    switch (signal) {
      case SIGSEGV:
        return "invalid memory access";
      case SIGBUS:
        return "access to memory that does not exist";
      case SIGFPE:
        return "arithmetic error";
      case SIGSYS:
        return "a system call that it is not allowed";
      case SIGILL:
        return "illegal instruction";
      case SIGABRT:
        return "abort";
      case SIGKILL:
        return "killed by another process, or because memory ran out";
      default:
        return sigdescr_np(signal);
    }
  }();
  return fmt::format("signal {} (SIG{}, {})", signal, name == nullptr ? "?" : name, meaning == nullptr ? "?" : meaning);
}

std::filesystem::path find_fmu_host() {
  if (const char* chosen = std::getenv("MEBOTS_FMU_HOST"); chosen != nullptr) return chosen;
  const auto places = program_places("mebots-fmu-host");
  std::error_code ignored;
  for (const auto& place : places) {
    if (std::filesystem::exists(place, ignored)) return place;
  }
  throw Error(
      ErrorCode::file_not_found,
      fmt::format("the program mebots-fmu-host, which runs an FMU in a process of its own, was not found at {}; set "
                  "MEBOTS_FMU_HOST to its path",
                  fmt::join(as_texts(places), ", ")));
}

}  // namespace mebots::master::isolation
