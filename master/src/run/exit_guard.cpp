// SPDX-License-Identifier: Apache-2.0
#include "run/exit_guard.hpp"

#include "base/time.hpp"
#include "slave/fmi2_callbacks.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <vector>

namespace mebots::master {
namespace {

struct Guards {
  std::mutex mutex;
  std::vector<const ExitGuard*> all;
};

Guards& guards() {
  static Guards& all = *new Guards;  // never destroyed: the end of the process asks it
  return all;
}

std::string reason(const char* function) {
  const auto call = current_call();
  constexpr const char* kRemedy =
      "which ends the whole process. Run the instance in a process of its own (\"process\": \"own\", or --isolate)";
  if (call.library != nullptr)
    return fmt::format("the library of the FMU {} called {}() while it was {}, {}", call.library, function,
                       call.function, kRemedy);
  if (call.instance == nullptr)
    return fmt::format("a library of an FMU called {}() in the middle of a run, {}", function, kRemedy);
  return fmt::format("instance '{}' at {} s: its FMU called {}() in {}, {}", call.instance, to_seconds(call.time_ns),
                     function, call.function, kRemedy);
}

/// Of the C library, with the FMU still below it on the stack.
bool ask_to_hear_of_ends() {
  return std::atexit([] { end_busy_runs("exit"); }) == 0 &&
         std::at_quick_exit([] { end_busy_runs("quick_exit"); }) == 0;
}

}  // namespace

void end_busy_runs(const char* function) {
  std::vector<const ExitGuard*> busy;
  {
    auto& known = guards();
    const std::lock_guard lock(known.mutex);
    std::ranges::copy_if(known.all, std::back_inserter(busy), &ExitGuard::busy);
    for (const auto* guard : busy) std::erase(known.all, guard);  // its end is told once, whoever ends the process then
  }
  if (busy.empty()) return;
  const auto what = reason(function);
  for (const auto* guard : busy) guard->fail(what);
  std::fprintf(stderr, "mebots: error: %s\n", what.c_str());
  std::fflush(nullptr);
  _exit(EXIT_FAILURE);
}

ExitGuard::ExitGuard(const bool& busy, Fail fail) : busy_(&busy), process_(getpid()), fail_(std::move(fail)) {
  static const bool asked = ask_to_hear_of_ends();
  static_cast<void>(asked);
  auto& known = guards();
  const std::lock_guard lock(known.mutex);
  known.all.push_back(this);
}

ExitGuard::~ExitGuard() {
  auto& known = guards();
  const std::lock_guard lock(known.mutex);
  std::erase(known.all, this);
}

bool ExitGuard::busy() const {
  return *busy_ && process_ == getpid();
}

}  // namespace mebots::master
