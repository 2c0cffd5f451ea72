// SPDX-License-Identifier: Apache-2.0
#include "slave/crash_notice.hpp"

#include "slave/fmi2_callbacks.hpp"

#include <unistd.h>

#include <array>
#include <charconv>
#include <csignal>
#include <cstddef>
#include <string_view>

namespace mebots::master {
namespace {

constexpr std::array kSignals = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};

std::string_view name_of(int signal) {
  switch (signal) {
    case SIGSEGV:
      return "SIGSEGV (invalid memory access)";
    case SIGBUS:
      return "SIGBUS (memory that is not there)";
    case SIGFPE:
      return "SIGFPE (arithmetic error)";
    case SIGILL:
      return "SIGILL (invalid instruction)";
    default:
      return "SIGABRT (abort)";
  }
}

/// A line that is put together without asking for memory.
class Line {
 public:
  Line& operator<<(std::string_view text) {
    for (const char c : text) {
      if (size_ < bytes_.size()) bytes_[size_++] = c;
    }
    return *this;
  }
  Line& operator<<(std::int64_t number) {
    std::array<char, 24> digits;
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
    return *this << std::string_view(digits.data(), static_cast<std::size_t>(end - digits.data()));
  }
  void write_to(int descriptor) const { static_cast<void>(!::write(descriptor, bytes_.data(), size_)); }

 private:
  std::array<char, 1024> bytes_;
  std::size_t size_ = 0;
};

void on_signal(int signal) {
  constexpr std::int64_t kPerMillisecond = 1'000'000;
  constexpr std::string_view kRemedy =
      ". Run the instance in a process of its own (\"process\": \"own\", or --isolate)\n";
  const auto call = current_call();
  const auto callback = current_callback();
  if (call.instance != nullptr && callback.name != nullptr && !callback.only_memory) {
    Line line;
    line << "mebots: error: instance '" << call.instance << "' at " << call.time_ns / kPerMillisecond
         << " ms: mebots failed by " << name_of(signal) << " in its callback " << callback.name << ", called from "
         << call.function
         << ". This is a mistake in mebots, unless the FMU damaged the memory of both: mebots check can tell. Please "
            "report it\n";
    line.write_to(STDERR_FILENO);
  } else if (call.instance != nullptr) {
    Line line;
    line << "mebots: error: instance '" << call.instance << "' at " << call.time_ns / kPerMillisecond
         << " ms: its FMU ended the process by " << name_of(signal) << " in " << call.function;
    if (callback.name != nullptr) line << ", by what it handed to " << callback.name << " or had damaged before";
    line << kRemedy;
    line.write_to(STDERR_FILENO);
  } else if (call.library != nullptr) {
    Line line;
    line << "mebots: error: the library of the FMU " << call.library << " ended the process by " << name_of(signal)
         << " while it was " << call.function << kRemedy;
    line.write_to(STDERR_FILENO);
  }
  raise(signal);  // SA_RESETHAND: it finds the default, once this handler is left
}

}  // namespace

void install_crash_notice() {
  // The stack may be what is broken.
  static std::array<std::byte, 1 << 16> stack;
  stack_t known{};
  if (sigaltstack(nullptr, &known) == 0 && (known.ss_flags & SS_DISABLE) != 0) {
    stack_t alternative{};
    alternative.ss_sp = stack.data();
    alternative.ss_size = stack.size();
    sigaltstack(&alternative, nullptr);
  }
  struct sigaction action {};
  action.sa_handler = &on_signal;
  action.sa_flags = SA_ONSTACK | static_cast<int>(SA_RESETHAND);
  sigemptyset(&action.sa_mask);
  for (const int signal : kSignals) {
    struct sigaction before {};
    if (sigaction(signal, nullptr, &before) == 0 && before.sa_handler == SIG_DFL) sigaction(signal, &action, nullptr);
  }
}

}  // namespace mebots::master
