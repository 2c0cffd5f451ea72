// SPDX-License-Identifier: Apache-2.0
#include "guard.hpp"

#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <malloc.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <fstream>
#include <vector>

namespace mebots::master::isolation {
namespace {

// A signal handler can reach nothing but a global.
Control* told = nullptr;

/// How far from the stack pointer a fault counts as the stack's end: a large frame is entered at its far end.
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
    told->fault_address.store(address, std::memory_order_relaxed);
    const auto stack = stack_pointer(context);
    const auto distance = address > stack ? address - stack : stack - address;
    told->fault_on_stack.store(signal == SIGSEGV && distance < kStackReach ? 1 : 0, std::memory_order_relaxed);
    told->fault_seen.store(1, std::memory_order_release);
  }
  std::signal(signal, SIG_DFL);
  raise(signal);
}

void tell_of_faults(Control& control) {
  told = &control;
  // The stack may be what is broken.
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

void limit_memory(std::uint64_t memory_bytes) {
  // Of address space, since that is what the kernel can limit; it counts from what the process has now.
  mallopt(M_ARENA_MAX, 2);  // otherwise every thread sets 64 MiB of address space aside
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  const auto limit = pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)) + memory_bytes;
  const rlimit address_space{limit, limit};
  setrlimit(RLIMIT_AS, &address_space);
}

void forbid_signals_to(pid_t master) {
#if defined(__x86_64__)
  // Where the system does not allow such a filter, an FMU can send signals to the master as any process of this user
  // can; nothing else is lost.
  const auto arch = static_cast<unsigned>(offsetof(seccomp_data, arch));
  const auto number = static_cast<unsigned>(offsetof(seccomp_data, nr));
  const auto target = static_cast<unsigned>(offsetof(seccomp_data, args));  // its low half: a pid_t
  std::vector<sock_filter> program = {BPF_STMT(BPF_LD | BPF_W | BPF_ABS, arch),
                                      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, AUDIT_ARCH_X86_64, 1, 0),
                                      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW)};
  const auto forbid = [&](long call, const std::vector<pid_t>& targets) {
    const auto count = static_cast<std::uint8_t>(2 * targets.size() + 1);
    program.push_back(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, number));
    program.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<unsigned>(call), 0, count));
    program.push_back(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, target));
    for (const auto pid : targets) {
      program.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<unsigned>(pid), 0, 1));
      program.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EPERM));
    }
  };
  forbid(SYS_kill, {master, -getpgid(master), -1});
  for (const long call : {SYS_tkill, SYS_tgkill, SYS_rt_sigqueueinfo, SYS_rt_tgsigqueueinfo, SYS_pidfd_open}) {
    forbid(call, {master});
  }
  program.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW));
  const sock_fprog filter{static_cast<unsigned short>(program.size()), program.data()};
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0) prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter, 0, 0);
#else
  (void)master;
#endif
}

}  // namespace

void guard(pid_t master, std::uint64_t memory_bytes, Control& control) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != master) std::_Exit(0);  // it went before we could ask to go with it
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  tell_of_faults(control);
  limit_memory(memory_bytes);
  forbid_signals_to(master);
}

}  // namespace mebots::master::isolation
