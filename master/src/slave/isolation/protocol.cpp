// SPDX-License-Identifier: Apache-2.0
#include "protocol.hpp"

#include "mebots/assert.hpp"

#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <climits>
#include <ctime>
#include <thread>

namespace mebots::master::isolation {
namespace {

/// About 10 us: the cost of sleeping and waking.
constexpr int kSpins = 300;

void pause() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#endif
}

long futex(std::atomic<std::uint32_t>& word, int operation, std::uint32_t value, const timespec* timeout) {
  return syscall(SYS_futex, &word, operation, value, timeout, nullptr, 0);
}

}  // namespace

const char* name_of(Call call) {
  switch (call) {
    case Call::none:
      return "the start of its process";
    case Call::open:
      return "loading or instantiation";
    case Call::setup_experiment:
      return "fmi2SetupExperiment";
    case Call::enter_initialization:
      return "fmi2EnterInitializationMode";
    case Call::exit_initialization:
      return "fmi2ExitInitializationMode";
    case Call::step:
      return "fmi2DoStep";
    case Call::finish_step:
      return "fmi2DoStep, which returned fmi2Pending,";
    case Call::terminate:
      return "fmi2Terminate";
    case Call::get_reals:
      return "fmi2GetReal";
    case Call::get_integers:
      return "fmi2GetInteger";
    case Call::get_booleans:
      return "fmi2GetBoolean";
    case Call::get_strings:
      return "fmi2GetString";
    case Call::get_binaries:
      return "fmi3GetBinary";
    case Call::set_reals:
      return "fmi2SetReal";
    case Call::set_integers:
      return "fmi2SetInteger";
    case Call::set_booleans:
      return "fmi2SetBoolean";
    case Call::set_strings:
      return "fmi2SetString";
    case Call::set_binaries:
      return "fmi3SetBinary";
    case Call::get_output_derivatives:
      return "fmi2GetRealOutputDerivatives";
    case Call::set_input_derivatives:
      return "fmi2SetRealInputDerivatives";
    case Call::save_state:
      return "fmi2GetFMUstate";
    case Call::restore_state:
      return "fmi2SetFMUstate";
    case Call::free_state:
      return "fmi2FreeFMUstate";
    case Call::serialize:
      return "fmi2SerializeFMUstate";
    case Call::deserialize:
      return "fmi2DeSerializeFMUstate";
    case Call::close:
      return "fmi2FreeInstance";
    case Call::unload:
      return "the destructors of its library";
  }
  return "an unknown call";  // the value is in shared memory and may be invalid
}

void Turn::pass() {
  value_.fetch_add(1, std::memory_order_seq_cst);
  if (sleeping_.load(std::memory_order_seq_cst) != 0) futex(value_, FUTEX_WAKE, INT_MAX, nullptr);
}

bool Turn::wait(std::uint32_t seen, std::int64_t timeout_ns) {
  MEBOTS_ASSERT(timeout_ns > 0, "0 would be a busy loop");
  static const int spins = std::thread::hardware_concurrency() > 1 ? kSpins : 0;
  for (int i = 0; i < spins; ++i) {
    if (value() != seen) return true;
    pause();
  }
  constexpr std::int64_t kPerSecond = 1'000'000'000;
  const timespec timeout{timeout_ns / kPerSecond, timeout_ns % kPerSecond};
  sleeping_.store(1, std::memory_order_seq_cst);
  if (value_.load(std::memory_order_seq_cst) == seen) futex(value_, FUTEX_WAIT, seen, &timeout);
  sleeping_.store(0, std::memory_order_seq_cst);
  return value() != seen;
}

}  // namespace mebots::master::isolation
