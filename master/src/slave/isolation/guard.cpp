// SPDX-License-Identifier: Apache-2.0
#include "guard.hpp"

#include "sandbox.hpp"

#include <asm/sockios.h>
#include <fcntl.h>
#include <malloc.h>
#include <sched.h>
#include <seccomp.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

namespace mebots::master::isolation {
namespace {

// Global, because a signal handler has no access to other objects.
Control* shared_control = nullptr;

/// A fault within this distance of the stack pointer is reported as a stack overflow. The first access to a large stack
/// frame may be at its far end.
constexpr std::uintptr_t kStackReach = 1 << 20;

std::uintptr_t stack_pointer(void* context) {
#if defined(__x86_64__)
  return static_cast<std::uintptr_t>(static_cast<ucontext_t*>(context)->uc_mcontext.gregs[REG_RSP]);
#else
  (void)context;
  return 0;
#endif
}

void on_fault(int signal, siginfo_t* info, void* context) {
  const auto address = reinterpret_cast<std::uintptr_t>(info->si_addr);
  const bool by_kernel = info->si_code > 0;
  if (by_kernel && signal != SIGABRT) {
    shared_control->fault_address.store(address, std::memory_order_relaxed);
    const auto stack = stack_pointer(context);
    const auto distance = address > stack ? address - stack : stack - address;
    shared_control->fault_on_stack.store(signal == SIGSEGV && distance < kStackReach ? 1 : 0,
                                         std::memory_order_relaxed);
    shared_control->fault_seen.store(1, std::memory_order_release);
  }
  std::signal(signal, SIG_DFL);
  raise(signal);
}

void install_fault_handlers(Control& control) {
  shared_control = &control;
  // The handler needs its own stack, because the stack of the thread may have overflowed.
  static std::array<std::byte, 1 << 16> stack;
  stack_t alternative{};
  alternative.ss_sp = stack.data();
  alternative.ss_size = stack.size();
  sigaltstack(&alternative, nullptr);
  struct sigaction action {};
  action.sa_sigaction = &on_fault;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK | static_cast<int>(SA_RESETHAND);
  sigemptyset(&action.sa_mask);
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL}) sigaction(signal, &action, nullptr);
}

void limit_memory(std::uint64_t memory_bytes, LimitedMemory limited) {
  if (memory_bytes == std::numeric_limits<std::uint64_t>::max()) return;  // no limit
  if (limited == LimitedMemory::data) {
    const rlimit data{memory_bytes, memory_bytes};
    setrlimit(RLIMIT_DATA, &data);
    return;
  }
  // The process may use `memory_bytes` in addition to its current memory.
  mallopt(M_ARENA_MAX, 2);  // otherwise, every thread reserves 64 MiB of address space
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  const auto limit = pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)) + memory_bytes;
  const rlimit address_space{limit, limit};
  setrlimit(RLIMIT_AS, &address_space);
}

/// Compares only the low 32 bits of a register, because the argument has 32 bits.
scmp_arg_cmp is(unsigned argument, std::uint32_t value) {
  return {argument, SCMP_CMP_MASKED_EQ, 0xffff'ffff, value};
}
scmp_arg_cmp is_not(unsigned argument, std::uint32_t value) {
  return {argument, SCMP_CMP_NE, value, 0};
}

}  // namespace

void forbid_harm(Signals signals) {
  const auto filter = seccomp_init(SCMP_ACT_ALLOW);
  if (filter == nullptr) return;
  seccomp_attr_set(filter, SCMP_FLTATR_ACT_BADARCH, SCMP_ACT_KILL_PROCESS);
  const auto forbid = [&](int call, const std::vector<scmp_arg_cmp>& where = {}) {
    const auto count = static_cast<unsigned>(where.size());
    const int problem = seccomp_rule_add_array(filter, SCMP_ACT_ERRNO(EPERM), call, count, where.data());
    if (problem != 0)
      throw Error(std::string("the kernel rejected a rule for system calls: ") + std::strerror(-problem));
  };
  const auto self = static_cast<std::uint32_t>(getpid());
  if (signals == Signals::to_itself) {
    // Only the id of this process is permitted. 0 and negative numbers are process groups, which may contain other
    // processes.
    for (const int call : {SCMP_SYS(kill), SCMP_SYS(rt_sigqueueinfo), SCMP_SYS(tgkill), SCMP_SYS(rt_tgsigqueueinfo),
                           SCMP_SYS(pidfd_open)}) {
      forbid(call, {is_not(0, self)});
    }
    // These calls are always forbidden. Their first argument is a thread or a descriptor, and a filter cannot find out
    // to which process it belongs.
    for (const int call : {SCMP_SYS(tkill), SCMP_SYS(pidfd_send_signal)}) forbid(call);
  }
  // Forbids access to memory and limits of other processes. The host reads its own memory for texts of callbacks.
  for (const int call : {SCMP_SYS(process_vm_readv), SCMP_SYS(process_vm_writev)}) {
    forbid(call, {is_not(0, self)});
  }
  forbid(SCMP_SYS(prlimit64), {is_not(0, 0)});  // 0 denotes the process itself
  for (const int call : {SCMP_SYS(ptrace), SCMP_SYS(pidfd_getfd), SCMP_SYS(process_madvise)}) forbid(call);
  // Forbids signals that the kernel sends at file events.
  for (const std::uint32_t command : {F_SETOWN, F_SETOWN_EX, F_SETSIG}) {
    forbid(SCMP_SYS(fcntl), {is(1, command)});
  }
  for (const std::uint32_t request : {FIOSETOWN, SIOCSPGRP}) {
    forbid(SCMP_SYS(ioctl), {is(1, request)});
  }
  // Forbids access to parts of the kernel that no simulation needs. A filter cannot read the flags of clone3, which are
  // in memory. clone3 fails with ENOSYS, so that the C library calls clone.
  for (const int call : {SCMP_SYS(unshare), SCMP_SYS(setns), SCMP_SYS(bpf), SCMP_SYS(perf_event_open),
                         SCMP_SYS(userfaultfd), SCMP_SYS(io_uring_setup), SCMP_SYS(add_key), SCMP_SYS(keyctl)}) {
    forbid(call);
  }
  forbid(SCMP_SYS(clone), {{0, SCMP_CMP_MASKED_EQ, CLONE_NEWUSER, CLONE_NEWUSER}});
  seccomp_rule_add(filter, SCMP_ACT_ERRNO(ENOSYS), SCMP_SYS(clone3), 0);
  seccomp_load(filter);  // libseccomp also sets PR_SET_NO_NEW_PRIVS
  seccomp_release(filter);
}

void guard(std::uint64_t memory_bytes, LimitedMemory limited, Control& control) {
  install_fault_handlers(control);
  limit_memory(memory_bytes, limited);
}

void protect_other_processes() {
  forbid_harm(shield_other_processes() ? Signals::to_children : Signals::to_itself);
}

}  // namespace mebots::master::isolation
