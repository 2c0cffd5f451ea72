// SPDX-License-Identifier: Apache-2.0
#include "sandbox.hpp"

#include "landlock.hpp"
#include "mebots/error.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/capability.h>
#include <poll.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <optional>

namespace mebots::master::isolation {
namespace {

bool write_text(const char* path, const std::string& text) {
  const int file = open(path, O_WRONLY | O_CLOEXEC);
  if (file < 0) return false;
  const bool done = write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  close(file);
  return done;
}

/// In it the process has the same user and group as outside, so that its files stay its own.
bool enter_user_namespace() {
  const auto user = getuid();
  const auto group = getgid();
  if (unshare(CLONE_NEWUSER) != 0) return false;
  return write_text("/proc/self/setgroups", "deny") &&
         write_text("/proc/self/uid_map", fmt::format("{0} {0} 1", user)) &&
         write_text("/proc/self/gid_map", fmt::format("{0} {0} 1", group));
}

/// Ends as another process ended.
[[noreturn]] void end_as(int status) {
  if (WIFSIGNALED(status)) {
    std::signal(WTERMSIG(status), SIG_DFL);
    raise(WTERMSIG(status));
  }
  _exit(WIFEXITED(status) ? WEXITSTATUS(status) : EXIT_FAILURE);
}

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

/// The first process of a namespace: when it ends, the kernel ends all others in it. It is not the one that runs the
/// FMU, for signals with their default action mean nothing to it.
[[noreturn]] void be_first(pid_t child, int report) {
  int status = 0;
  for (pid_t ended = 0; ended != child;) {
    ended = wait(&status);
    if (ended < 0 && errno != EINTR) break;
  }
  static_cast<void>(!::write(report, &status, sizeof status));
  _exit(EXIT_SUCCESS);
}

/// Outside, until the namespace is empty.
[[noreturn]] void stand_by(pid_t first, int report) {
  int status = 0;
  while (waitpid(first, &status, 0) < 0 && errno == EINTR) {
  }
  int of_the_worker = 0;
  if (read(report, &of_the_worker, sizeof of_the_worker) == static_cast<ssize_t>(sizeof of_the_worker))
    status = of_the_worker;
  end_as(status);
}

/// Returns in a process whose descendants nobody outside has to look after.
void fork_into_namespace() {
  Pipe report;  // how the worker ended
  Pipe alive;   // closed when who stands by is gone
  const auto first = fork_or_throw();
  if (first != 0) {
    report.close_end(1);
    stand_by(first, report.ends[0]);
  }
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  alive.close_end(1);
  pollfd gone{alive.ends[0], 0, 0};
  if (poll(&gone, 1, 0) > 0 && (gone.revents & POLLHUP) != 0) _exit(EXIT_FAILURE);  // before we could ask to go with it
  const auto worker = fork_or_throw();
  if (worker != 0) be_first(worker, report.ends[1]);
}

/// A user namespace gives its first process all powers over what is in it.
bool drop_capabilities() {
  __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
  std::array<__user_cap_data_struct, 2> none{};
  return syscall(SYS_capset, &header, none.data()) == 0;
}

}  // namespace

std::vector<std::string> enter_sandbox(const std::filesystem::path& folder) {
  std::vector<std::string> lacking;
  const auto note = [&](const char* what) { lacking.push_back(fmt::format("{} ({})", what, std::strerror(errno))); };
  if (!enter_user_namespace()) note("user namespace");
  if (unshare(CLONE_NEWNET) != 0) note("network namespace");
  if (unshare(CLONE_NEWIPC) != 0) note("namespace for System V memory");
  if (unshare(CLONE_NEWPID) != 0) {
    note("process namespace");
  } else {
    fork_into_namespace();
  }
  if (!drop_capabilities()) note("giving up capabilities");
  setenv("TMPDIR", folder.c_str(), 1);  // NOLINT(concurrency-mt-unsafe): one thread
  if (auto problem = restrict_files(folder); !problem.empty()) lacking.push_back(std::move(problem));
  return lacking;
}

}  // namespace mebots::master::isolation
