// SPDX-License-Identifier: Apache-2.0
#include "sandbox.hpp"

#include <fcntl.h>
#include <sched.h>
#include <seccomp.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <initializer_list>

namespace mebots::master::isolation {
namespace {

/// System calls that read, write and name files. The sandbox's file tree and Landlock limit the files.
constexpr auto kFiles = std::to_array<int>({
    SCMP_SYS(read),
    SCMP_SYS(write),
    SCMP_SYS(readv),
    SCMP_SYS(writev),
    SCMP_SYS(pread64),
    SCMP_SYS(pwrite64),
    SCMP_SYS(preadv),
    SCMP_SYS(pwritev),
    SCMP_SYS(preadv2),
    SCMP_SYS(pwritev2),
    SCMP_SYS(lseek),
    SCMP_SYS(close),
    SCMP_SYS(close_range),
    SCMP_SYS(dup),
    SCMP_SYS(dup2),
    SCMP_SYS(dup3),
    SCMP_SYS(open),
    SCMP_SYS(openat),
    SCMP_SYS(openat2),
    SCMP_SYS(creat),
    SCMP_SYS(stat),
    SCMP_SYS(lstat),
    SCMP_SYS(fstat),
    SCMP_SYS(newfstatat),
    SCMP_SYS(statx),
    SCMP_SYS(statfs),
    SCMP_SYS(fstatfs),
    SCMP_SYS(access),
    SCMP_SYS(faccessat),
    SCMP_SYS(faccessat2),
    SCMP_SYS(readlink),
    SCMP_SYS(readlinkat),
    SCMP_SYS(getcwd),
    SCMP_SYS(chdir),
    SCMP_SYS(fchdir),
    SCMP_SYS(getdents),
    SCMP_SYS(getdents64),
    SCMP_SYS(mkdir),
    SCMP_SYS(mkdirat),
    SCMP_SYS(rmdir),
    SCMP_SYS(unlink),
    SCMP_SYS(unlinkat),
    SCMP_SYS(rename),
    SCMP_SYS(renameat),
    SCMP_SYS(renameat2),
    SCMP_SYS(link),
    SCMP_SYS(linkat),
    SCMP_SYS(symlink),
    SCMP_SYS(symlinkat),
    SCMP_SYS(truncate),
    SCMP_SYS(ftruncate),
    SCMP_SYS(fallocate),
    SCMP_SYS(fsync),
    SCMP_SYS(fdatasync),
    SCMP_SYS(sync_file_range),
    SCMP_SYS(flock),
    SCMP_SYS(umask),
    SCMP_SYS(readahead),
    SCMP_SYS(fadvise64),
    SCMP_SYS(sendfile),
    SCMP_SYS(copy_file_range),
    SCMP_SYS(splice),
    SCMP_SYS(tee),
    SCMP_SYS(pipe),
    SCMP_SYS(pipe2),
    SCMP_SYS(poll),
    SCMP_SYS(ppoll),
    SCMP_SYS(select),
    SCMP_SYS(pselect6),
    SCMP_SYS(epoll_create),
    SCMP_SYS(epoll_create1),
    SCMP_SYS(epoll_ctl),
    SCMP_SYS(epoll_wait),
    SCMP_SYS(epoll_pwait),
    SCMP_SYS(epoll_pwait2),
    SCMP_SYS(eventfd),
    SCMP_SYS(eventfd2),
    SCMP_SYS(getxattr),
    SCMP_SYS(lgetxattr),
    SCMP_SYS(fgetxattr),
    SCMP_SYS(listxattr),
    SCMP_SYS(llistxattr),
    SCMP_SYS(flistxattr),
});

constexpr auto kMemory = std::to_array<int>({
    SCMP_SYS(mmap),
    SCMP_SYS(munmap),
    SCMP_SYS(mprotect),
    SCMP_SYS(mremap),
    SCMP_SYS(madvise),
    SCMP_SYS(brk),
    SCMP_SYS(msync),
    SCMP_SYS(mincore),
    SCMP_SYS(mlock),
    SCMP_SYS(mlock2),
    SCMP_SYS(munlock),
    SCMP_SYS(membarrier),
    SCMP_SYS(memfd_create),
    SCMP_SYS(pkey_alloc),
    SCMP_SYS(pkey_free),
    SCMP_SYS(pkey_mprotect),
    SCMP_SYS(get_mempolicy),
});

constexpr auto kProcesses = std::to_array<int>({
    SCMP_SYS(fork),
    SCMP_SYS(vfork),
    SCMP_SYS(execve),
    SCMP_SYS(execveat),
    SCMP_SYS(exit),
    SCMP_SYS(exit_group),
    SCMP_SYS(wait4),
    SCMP_SYS(waitid),
    SCMP_SYS(getpid),
    SCMP_SYS(getppid),
    SCMP_SYS(gettid),
    SCMP_SYS(getuid),
    SCMP_SYS(geteuid),
    SCMP_SYS(getgid),
    SCMP_SYS(getegid),
    SCMP_SYS(getresuid),
    SCMP_SYS(getresgid),
    SCMP_SYS(getgroups),
    SCMP_SYS(getpgid),
    SCMP_SYS(getpgrp),
    SCMP_SYS(getsid),
    SCMP_SYS(setsid),
    SCMP_SYS(setpgid),
    SCMP_SYS(capget),
    SCMP_SYS(getrlimit),
    SCMP_SYS(setrlimit),
    SCMP_SYS(getrusage),
    SCMP_SYS(sysinfo),
    SCMP_SYS(uname),
    SCMP_SYS(getrandom),
    SCMP_SYS(futex),
    SCMP_SYS(futex_waitv),
    SCMP_SYS(set_robust_list),
    SCMP_SYS(get_robust_list),
    SCMP_SYS(set_tid_address),
    SCMP_SYS(rseq),
    SCMP_SYS(sched_yield),
    SCMP_SYS(sched_getaffinity),
    SCMP_SYS(sched_setaffinity),
    SCMP_SYS(sched_getparam),
    SCMP_SYS(sched_getscheduler),
    SCMP_SYS(sched_get_priority_max),
    SCMP_SYS(sched_get_priority_min),
    SCMP_SYS(getpriority),
    SCMP_SYS(getcpu),
    SCMP_SYS(arch_prctl),
    SCMP_SYS(seccomp),
    SCMP_SYS(landlock_create_ruleset),
    SCMP_SYS(landlock_add_rule),
    SCMP_SYS(landlock_restrict_self),
    SCMP_SYS(restart_syscall),
});

constexpr auto kSignalsAndTime = std::to_array<int>({
    SCMP_SYS(rt_sigaction),  SCMP_SYS(rt_sigprocmask),  SCMP_SYS(rt_sigreturn),    SCMP_SYS(rt_sigpending),
    SCMP_SYS(rt_sigsuspend), SCMP_SYS(rt_sigtimedwait), SCMP_SYS(sigaltstack),     SCMP_SYS(signalfd),
    SCMP_SYS(signalfd4),     SCMP_SYS(pause),           SCMP_SYS(nanosleep),       SCMP_SYS(clock_nanosleep),
    SCMP_SYS(clock_gettime), SCMP_SYS(clock_getres),    SCMP_SYS(gettimeofday),    SCMP_SYS(time),
    SCMP_SYS(times),         SCMP_SYS(getitimer),       SCMP_SYS(setitimer),       SCMP_SYS(alarm),
    SCMP_SYS(timer_create),  SCMP_SYS(timer_settime),   SCMP_SYS(timer_gettime),   SCMP_SYS(timer_getoverrun),
    SCMP_SYS(timer_delete),  SCMP_SYS(timerfd_create),  SCMP_SYS(timerfd_settime), SCMP_SYS(timerfd_gettime),
});

/// System calls that send signals. Inside a process namespace, they reach only processes of the sandbox.
constexpr auto kSendSignals =
    std::to_array<int>({SCMP_SYS(kill), SCMP_SYS(tkill), SCMP_SYS(tgkill), SCMP_SYS(rt_sigqueueinfo),
                        SCMP_SYS(rt_tgsigqueueinfo), SCMP_SYS(pidfd_open), SCMP_SYS(pidfd_send_signal)});

/// System calls that are permitted only inside namespaces. They access network peers, System V objects, or attributes
/// of files, which Landlock does not control.
constexpr auto kPrivate = std::to_array<int>({
    SCMP_SYS(chmod),     SCMP_SYS(fchmod),      SCMP_SYS(fchmodat),    SCMP_SYS(utime),      SCMP_SYS(utimes),
    SCMP_SYS(futimesat), SCMP_SYS(utimensat),   SCMP_SYS(chown),       SCMP_SYS(fchown),     SCMP_SYS(lchown),
    SCMP_SYS(fchownat),  SCMP_SYS(bind),        SCMP_SYS(listen),      SCMP_SYS(accept),     SCMP_SYS(accept4),
    SCMP_SYS(connect),   SCMP_SYS(getsockname), SCMP_SYS(getpeername), SCMP_SYS(getsockopt), SCMP_SYS(setsockopt),
    SCMP_SYS(shmget),    SCMP_SYS(shmat),       SCMP_SYS(shmctl),      SCMP_SYS(shmdt),      SCMP_SYS(semget),
    SCMP_SYS(semop),     SCMP_SYS(semctl),      SCMP_SYS(semtimedop),  SCMP_SYS(msgget),     SCMP_SYS(msgsnd),
    SCMP_SYS(msgrcv),    SCMP_SYS(msgctl),
});

/// System calls for socket pairs. They are always permitted. Inside a network namespace, they may also access other
/// sockets.
constexpr auto kSocketData =
    std::to_array<int>({SCMP_SYS(sendto), SCMP_SYS(recvfrom), SCMP_SYS(sendmsg), SCMP_SYS(recvmsg), SCMP_SYS(sendmmsg),
                        SCMP_SYS(recvmmsg), SCMP_SYS(shutdown)});

constexpr auto kFcntlCommands = std::to_array<std::uint32_t>(
    {F_DUPFD, F_DUPFD_CLOEXEC, F_GETFD, F_SETFD, F_GETFL, F_SETFL, F_GETLK, F_SETLK, F_SETLKW, F_OFD_GETLK, F_OFD_SETLK,
     F_OFD_SETLKW, F_GET_SEALS, F_ADD_SEALS, F_GETPIPE_SZ, F_SETPIPE_SZ});
constexpr auto kIoctlRequests =
    std::to_array<std::uint32_t>({TCGETS, TIOCGWINSZ, FIONREAD, FIONBIO, FIOCLEX, FIONCLEX});
constexpr std::uint32_t kSetMemoryName = 0x53564d41;  // PR_SET_VMA
constexpr auto kPrctlOptions = std::to_array<std::uint32_t>(
    {PR_SET_NAME, PR_GET_NAME, PR_SET_PDEATHSIG, PR_GET_PDEATHSIG, PR_SET_NO_NEW_PRIVS, PR_GET_NO_NEW_PRIVS,
     PR_GET_DUMPABLE, PR_CAPBSET_READ, PR_GET_SECCOMP, PR_SET_TIMERSLACK, PR_GET_TIMERSLACK, kSetMemoryName});
constexpr auto kSocketFamilies = std::to_array<std::uint32_t>({AF_UNIX, AF_INET, AF_INET6});

/// Compares only the low 32 bits of a register, because the argument has 32 bits.
scmp_arg_cmp equals(unsigned argument, std::uint32_t value) {
  return {argument, SCMP_CMP_MASKED_EQ, 0xffff'ffff, value};
}

/// Builds a seccomp filter and stores the first error.
class Filter {
 public:
  Filter() : context_(seccomp_init(SCMP_ACT_ERRNO(EPERM))) {
    if (context_ == nullptr) problem_ = ENOMEM;
  }
  ~Filter() {
    if (context_ != nullptr) seccomp_release(context_);
  }
  Filter(const Filter&) = delete;
  Filter& operator=(const Filter&) = delete;

  template <std::size_t count>
  void allow(const std::array<int, count>& calls) {
    for (const int call : calls) add(SCMP_ACT_ALLOW, call, {});
  }
  void allow(int call, std::initializer_list<scmp_arg_cmp> where) { add(SCMP_ACT_ALLOW, call, where); }
  template <std::size_t count>
  void allow_by(int call, unsigned argument, const std::array<std::uint32_t, count>& values) {
    for (const auto value : values) add(SCMP_ACT_ALLOW, call, {equals(argument, value)});
  }
  void answer(int call, int error) { add(SCMP_ACT_ERRNO(static_cast<unsigned>(error)), call, {}); }

  /// Loads the filter into the kernel. Returns 0 or an error number.
  int load() {
    keep(seccomp_attr_set(context_, SCMP_FLTATR_ACT_BADARCH, SCMP_ACT_KILL_PROCESS));
    return problem_ != 0 ? problem_ : -seccomp_load(context_);
  }

 private:
  /// Adds a rule. Has no effect if `call` is negative, because this architecture lacks the system call.
  void add(std::uint32_t action, int call, std::initializer_list<scmp_arg_cmp> where) {
    if (context_ == nullptr || call < 0) return;
    keep(seccomp_rule_add_array(context_, action, call, static_cast<unsigned>(where.size()), where.begin()));
  }
  void keep(int result) {
    if (problem_ == 0 && result < 0) problem_ = -result;
  }

  scmp_filter_ctx context_;
  int problem_ = 0;
};

}  // namespace

std::optional<std::string> allow_simulation_calls(bool has_namespaces) {
  Filter filter;
  const auto self = static_cast<std::uint32_t>(getpid());
  filter.allow(kFiles);
  filter.allow(kMemory);
  filter.allow(kProcesses);
  filter.allow(kSignalsAndTime);
  filter.allow(kSocketData);
  filter.allow_by(SCMP_SYS(fcntl), 1, kFcntlCommands);
  filter.allow_by(SCMP_SYS(ioctl), 1, kIoctlRequests);
  filter.allow_by(SCMP_SYS(prctl), 0, kPrctlOptions);
  filter.allow(SCMP_SYS(socketpair), {equals(0, AF_UNIX)});
  filter.allow(SCMP_SYS(personality), {equals(0, 0xffff'ffff)});  // only the query
  filter.allow(SCMP_SYS(prlimit64), {equals(0, 0)});              // only the limits of this process
  // Permits reading this process only, for the texts of callbacks.
  filter.allow(SCMP_SYS(process_vm_readv), {equals(0, self)});
  constexpr std::uint64_t kNewNamespaces =
      CLONE_NEWCGROUP | CLONE_NEWIPC | CLONE_NEWNET | CLONE_NEWNS | CLONE_NEWPID | CLONE_NEWUSER | CLONE_NEWUTS;
  filter.allow(SCMP_SYS(clone), {{0, SCMP_CMP_MASKED_EQ, kNewNamespaces, 0}});
  // clone3 has its flags in memory, which a filter cannot read. After ENOSYS, the C library calls clone().
  filter.answer(SCMP_SYS(clone3), ENOSYS);
  if (has_namespaces) {
    filter.allow(kSendSignals);
    filter.allow(kPrivate);
    filter.allow_by(SCMP_SYS(socket), 0, kSocketFamilies);
  } else {
    for (const int call : {SCMP_SYS(kill), SCMP_SYS(tgkill), SCMP_SYS(rt_sigqueueinfo)})
      filter.allow(call, {equals(0, self)});
  }
  const int problem = filter.load();
  if (problem == 0) return std::nullopt;
  return std::strerror(problem);
}

}  // namespace mebots::master::isolation
