// SPDX-License-Identifier: Apache-2.0
#include "sandbox.hpp"

#include "keeper.hpp"
#include "landlock.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/capability.h>
#include <sched.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>

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

/// A user namespace gives its first process all powers over what is in it.
bool drop_capabilities() {
  __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
  std::array<__user_cap_data_struct, 2> none{};
  return syscall(SYS_capset, &header, none.data()) == 0;
}

}  // namespace

std::vector<std::string> enter_sandbox(const std::filesystem::path& folder, pid_t master) {
  std::vector<std::string> lacking;
  const auto note = [&](const char* what) { lacking.push_back(fmt::format("{} ({})", what, std::strerror(errno))); };
  if (!enter_user_namespace()) note("user namespace");
  if (unshare(CLONE_NEWNET) != 0) note("network namespace");
  if (unshare(CLONE_NEWIPC) != 0) note("namespace for System V memory");
  if (unshare(CLONE_NEWPID) != 0) {
    note("process namespace");
    fork_kept(master);
  } else {
    fork_kept_into_namespace(master);
  }
  if (!drop_capabilities()) note("giving up capabilities");
  setenv("TMPDIR", folder.c_str(), 1);  // NOLINT(concurrency-mt-unsafe): one thread
  if (auto problem = restrict_files(folder); !problem.empty()) lacking.push_back(std::move(problem));
  return lacking;
}

}  // namespace mebots::master::isolation
