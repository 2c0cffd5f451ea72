// SPDX-License-Identifier: Apache-2.0
#include "fmi/call/exit_guard.hpp"

#include "base/signal_guard.hpp"
#include "fmi/call/callbacks.hpp"

#include <fmt/format.h>

#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstring>
#include <string_view>

namespace mebots::master {
namespace {

constexpr std::array kCrashes = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTRAP, SIGSYS};
/// Signals that timers, file descriptors and this process may send. install_crash_notice() adds the real-time signals.
constexpr std::array kEnds = {SIGALRM, SIGVTALRM, SIGPROF, SIGUSR1, SIGUSR2, SIGPOLL, SIGSTKFLT};

std::string_view name_of(int signal) {
  switch (signal) {
    case SIGSEGV:
      return "SIGSEGV (invalid memory access)";
    case SIGBUS:
      return "SIGBUS (access to memory that does not exist)";
    case SIGFPE:
      return "SIGFPE (arithmetic error)";
    case SIGILL:
      return "SIGILL (invalid instruction)";
    case SIGTRAP:
      return "SIGTRAP (breakpoint)";
    case SIGSYS:
      return "SIGSYS (a system call that is not allowed)";
    default:
      return "SIGABRT (abort)";
  }
}

/// Reports a crash on a thread outside of calls to FMUs. The thread may belong to an FMU, to the embedding program or
/// to mebots.
void report_other_thread(int signal) {
  SignalLine line;
  line << "mebots: error: " << name_of(signal) << " ended the process on a thread outside of calls to FMUs. ";
  bool any = false;
  for_each_instance([&](const char* name) {
    line << (any ? ", '" : "FMUs may have threads of their own; the instances in this process: '") << name << "'";
    any = true;
  });
  line << (any ? "\n" : "This is a mistake in mebots. Please report it\n");
  line.write_to(STDERR_FILENO);
}

void on_crash(int signal) {
  constexpr std::int64_t kPerMillisecond = 1'000'000;
  constexpr std::string_view kRemedy =
      ". Run the instance in a separate process (\"process\": \"own\", or --isolate)\n";
  const auto call = current_call();
  const auto entered = current_callback();
  if (call.instance != nullptr && entered.name != nullptr && !entered.only_memory) {
    SignalLine line;
    line << "mebots: error: instance '" << call.instance << "' at " << call.time_ns / kPerMillisecond
         << " ms: mebots failed by " << name_of(signal) << " in its callback " << entered.name << ", called from "
         << call.function
         << ". This is a mistake in mebots, unless the FMU damaged memory of mebots: `mebots check` can find out. "
            "Please "
            "report it\n";
    line.write_to(STDERR_FILENO);
  } else if (call.instance != nullptr) {
    SignalLine line;
    line << "mebots: error: instance '" << call.instance << "' at " << call.time_ns / kPerMillisecond
         << " ms: its FMU ended the process by " << name_of(signal) << " in " << call.function;
    if (entered.name != nullptr)
      line << ", because of a pointer that it passed to " << entered.name
           << ", or of memory that this FMU damaged earlier";
    line << kRemedy;
    line.write_to(STDERR_FILENO);
  } else if (call.library != nullptr) {
    SignalLine line;
    line << "mebots: error: the library of the FMU " << call.library << " ended the process by " << name_of(signal)
         << " while it was " << call.function << kRemedy;
    line.write_to(STDERR_FILENO);
  } else {
    report_other_thread(signal);
  }
  raise(signal);  // SA_RESETHAND: the default action follows when this handler returns
}

bool is_sent_by_itself(const siginfo_t& info) {
  return info.si_code > 0 || info.si_code == SI_TIMER || info.si_code == SI_SIGIO || info.si_pid == getpid();
}

void on_end(int signal, siginfo_t* info, void* /*context*/) {
  const int error = errno;
  if (is_sent_by_itself(*info) && end_by_signal(signal)) {
    errno = error;
    return;
  }
  std::signal(signal, SIG_DFL);
  raise(signal);  // takes effect when this handler returns
}

void handle(int signal, const struct sigaction& action) {
  struct sigaction before {};
  if (sigaction(signal, nullptr, &before) == 0 && before.sa_handler == SIG_DFL) sigaction(signal, &action, nullptr);
}

bool has_timer() {
  itimerval timer{};
  getitimer(ITIMER_REAL, &timer);
  return timer.it_value.tv_sec != 0 || timer.it_value.tv_usec != 0;
}

}  // namespace

void install_crash_notice() {
  // The handler needs its own stack, because the stack of the thread may have overflowed.
  static std::array<std::byte, 1 << 16> stack;
  stack_t known{};
  if (sigaltstack(nullptr, &known) == 0 && (known.ss_flags & SS_DISABLE) != 0) {
    stack_t alternative{};
    alternative.ss_sp = stack.data();
    alternative.ss_size = stack.size();
    sigaltstack(&alternative, nullptr);
  }
  struct sigaction crash {};
  crash.sa_handler = &on_crash;
  crash.sa_flags = SA_ONSTACK | static_cast<int>(SA_RESETHAND);
  sigemptyset(&crash.sa_mask);
  for (const int signal : kCrashes) handle(signal, crash);
  struct sigaction end {};
  end.sa_sigaction = &on_end;
  end.sa_flags = SA_SIGINFO | SA_RESTART;
  sigemptyset(&end.sa_mask);
  for (const int signal : kEnds) {
    if (signal != SIGALRM || !has_timer()) handle(signal, end);
  }
  for (int signal = SIGRTMIN; signal <= SIGRTMAX; ++signal) handle(signal, end);
}

bool ends_process(int signal) {
  struct sigaction action {};
  if (sigaction(signal, nullptr, &action) != 0) return false;  // the C library reserves this signal
  return action.sa_handler == SIG_DFL || action.sa_sigaction == &on_end;
}

std::string signal_name(int signal) {
  const char* const name = sigabbrev_np(signal);
  return name == nullptr ? fmt::format("signal {}", signal) : fmt::format("SIG{}", name);
}

}  // namespace mebots::master
