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

std::string reason() {
  const auto call = current_call();
  constexpr const char* kRemedy =
      "which ends the whole process. Run the instance in a process of its own (\"process\": \"own\", or --isolate)";
  if (call.library != nullptr)
    return fmt::format("the library of the FMU {} called exit() while it was {}, {}", call.library, call.function,
                       kRemedy);
  if (call.instance == nullptr)
    return fmt::format("a library of an FMU called exit() in the middle of a run, {}", kRemedy);
  return fmt::format("instance '{}' at {} s: its FMU called exit() in {}, {}", call.instance, to_seconds(call.time_ns),
                     call.function, kRemedy);
}

/// Runs on the thread that called exit(), with the FMU still below it on the stack.
void at_exit() {
  std::vector<const ExitGuard*> busy;
  {
    auto& known = guards();
    const std::lock_guard lock(known.mutex);
    std::ranges::copy_if(known.all, std::back_inserter(busy), &ExitGuard::busy);
  }
  if (busy.empty()) return;
  const auto what = reason();
  for (const auto* guard : busy) guard->fail(what);
  std::fprintf(stderr, "mebots: error: %s\n", what.c_str());
  std::fflush(nullptr);
  _exit(EXIT_FAILURE);
}

}  // namespace

ExitGuard::ExitGuard(const bool& busy, Fail fail) : busy_(&busy), fail_(std::move(fail)) {
  static const int registered = std::atexit(&at_exit);
  static_cast<void>(registered);
  auto& known = guards();
  const std::lock_guard lock(known.mutex);
  known.all.push_back(this);
}

ExitGuard::~ExitGuard() {
  auto& known = guards();
  const std::lock_guard lock(known.mutex);
  std::erase(known.all, this);
}

}  // namespace mebots::master
