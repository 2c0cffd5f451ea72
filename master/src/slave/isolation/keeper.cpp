// SPDX-License-Identifier: Apache-2.0
#include "child_process.hpp"

#include "mebots/error.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace mebots::master::isolation {
namespace {

using Clock = std::chrono::steady_clock;

/// The kernel sends this signal to the keeper when the thread that started it ends, even if the process of this thread
/// continues.
constexpr int kParentThreadEnded = SIGHUP;
constexpr int kAskedToEnd = SIGTERM;

constexpr std::chrono::seconds kPatience{5};
constexpr std::chrono::milliseconds kNap{1};

struct Pipe {
  std::array<int, 2> ends{-1, -1};
  Pipe() {
    if (pipe2(ends.data(), O_CLOEXEC) != 0)
      throw Error(ErrorCode::system_failure, fmt::format("no pipe: {}", std::strerror(errno)));
  }
  ~Pipe() {
    close_end(0);
    close_end(1);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  void close_end(std::size_t which) {
    if (ends[which] >= 0) close(ends[which]);
    ends[which] = -1;
  }
};

pid_t fork_or_throw() {
  const auto child = fork();
  if (child < 0) throw Error(ErrorCode::system_failure, fmt::format("no process: {}", std::strerror(errno)));
  return child;
}

/// Parses a number. Returns 0 if the text is not a number.
pid_t number_in(std::string_view text) {
  pid_t number = 0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

/// True if a process is a child of `parent`. In /proc/PID/stat, the name in parentheses precedes the state and the
/// parent.
bool is_child_of(const std::filesystem::path& process, pid_t parent) {
  std::ifstream file(process / "stat");
  std::string text;
  std::getline(file, text, '\0');
  const auto name_end = text.rfind(')');
  if (name_end == std::string::npos || name_end + 4 >= text.size()) return false;
  return number_in(std::string_view(text).substr(name_end + 4)) == parent;
}

std::vector<pid_t> children() {
  std::vector<pid_t> found;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/proc", ignored)) {
    const auto process = number_in(entry.path().filename().string());
    if (process > 0 && is_child_of(entry.path(), getpid())) found.push_back(process);
  }
  return found;
}

struct Child {
  pid_t number;
  int status = 0;
  bool ended = false;

  /// Reaps all ended processes, including adopted orphans. Returns false if there are no more child processes.
  bool reap() {
    int of_this = 0;
    pid_t one = 0;
    while ((one = waitpid(-1, &of_this, WNOHANG)) > 0) {
      if (one != number) continue;
      ended = true;
      status = of_this;
    }
    return one == 0 || errno != ECHILD;
  }
};

/// Ends all descendants of the child. If a descendant ends, its children become children of this process
/// (PR_SET_CHILD_SUBREAPER). Therefore ends all children of this process until there are no more.
void end_descendants(Child& child) {
  if (!child.ended) kill(child.number, SIGKILL);
  for (const auto until = Clock::now() + kPatience; child.reap() && Clock::now() < until;) {
    std::ranges::for_each(children(), [](pid_t one) { kill(one, SIGKILL); });
    std::this_thread::sleep_for(kNap);
  }
}

[[noreturn]] void end_as(int status) {
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    std::signal(signal, SIG_DFL);
    raise(signal);
    sigset_t only;
    sigemptyset(&only);
    sigaddset(&only, signal);
    sigprocmask(SIG_UNBLOCK, &only, nullptr);  // the signal ends the process here
  }
  _exit(WIFEXITED(status) ? WEXITSTATUS(status) : EXIT_FAILURE);
}

[[noreturn]] void keep(Child child, pid_t parent) {
  sigset_t all;
  sigfillset(&all);
  while (!child.ended) {
    siginfo_t info{};
    const int signal = sigwaitinfo(&all, &info);
    child.reap();
    if (signal == kAskedToEnd || (signal == kParentThreadEnded && getppid() != parent)) break;
  }
  end_descendants(child);
  end_as(child.status);
}

/// Must be called in the child. Makes the kernel end the child when its parent, the keeper, ends. If the keeper has
/// already ended, the pipe `alive` is closed at its other end, and this function ends the child.
void end_with_keeper(const Pipe& alive) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  pollfd gone{alive.ends[0], 0, 0};
  if (poll(&gone, 1, 0) > 0 && (gone.revents & POLLHUP) != 0) _exit(EXIT_FAILURE);  // the keeper had already ended
}

/// Makes this process a keeper (see fork_kept()). Returns the previous signal mask, which the child must restore.
sigset_t become_keeper(pid_t parent) {
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  sigprocmask(SIG_SETMASK, &all, &before);
  std::signal(SIGCHLD, SIG_DFL);  // if SIGCHLD is ignored, ended children leave no status
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  prctl(PR_SET_PDEATHSIG, kParentThreadEnded);
  if (getppid() != parent) _exit(EXIT_FAILURE);  // the parent had already ended
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  return before;
}

}  // namespace

void fork_kept(pid_t parent) {
  const auto mask = become_keeper(parent);
  Pipe alive;
  const auto child = fork_or_throw();
  if (child != 0) {
    alive.close_end(0);
    keep({child}, parent);
  }
  alive.close_end(1);
  end_with_keeper(alive);
  setsid();
  sigprocmask(SIG_SETMASK, &mask, nullptr);
}

void end_kept(pid_t keeper) {
  kill(keeper, kAskedToEnd);
  const auto ended = [keeper] {
    siginfo_t info{};
    return waitid(P_PID, static_cast<id_t>(keeper), &info, WEXITED | WNOHANG | WNOWAIT) != 0 || info.si_pid != 0;
  };
  for (const auto until = Clock::now() + 2 * kPatience; !ended();) {
    if (Clock::now() > until) kill(keeper, SIGKILL);
    std::this_thread::sleep_for(kNap);
  }
}

}  // namespace mebots::master::isolation
