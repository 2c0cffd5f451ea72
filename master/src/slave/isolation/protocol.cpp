// SPDX-License-Identifier: Apache-2.0
#include "protocol.hpp"

#include "mebots/assert.hpp"

#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <climits>
#include <ctime>
#include <thread>

namespace mebots::master::isolation {
namespace {

/// The number of spins before a wait sleeps. They take about 10 us, as long as sleeping and waking.
constexpr int kSpins = 300;

void pause() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#endif
}

long futex(std::atomic<std::uint32_t>& word, int operation, std::uint32_t value, const timespec* timeout) {
  return syscall(SYS_futex, &word, operation, value, timeout, nullptr, 0);
}

/// The FMI functions of a call, for messages. In FMI 3.0, the function depends on the type of a value.
struct Names {
  Call call;
  const char* fmi1;
  const char* fmi2;
  const char* fmi3;
};

constexpr Names common(Call call, const char* name) {
  return {call, name, name, name};
}

/// Returns the names of a call for FMI 2.0 and 3.0 only.
constexpr Names newer(Call call, const char* fmi2, const char* fmi3) {
  return {call, "an unknown call", fmi2, fmi3};
}

constexpr std::array kNames = {
    common(Call::none, "the start of its process"),
    common(Call::open, "loading or instantiation"),
    common(Call::unload, "the destructors of its library"),
    Names{Call::setup_experiment, "fmiInitializeSlave", "fmi2SetupExperiment", "fmi3EnterInitializationMode"},
    Names{Call::enter_initialization, "fmiInitializeSlave", "fmi2EnterInitializationMode",
          "fmi3EnterInitializationMode"},
    Names{Call::exit_initialization, "fmiInitializeSlave", "fmi2ExitInitializationMode", "fmi3ExitInitializationMode"},
    Names{Call::step, "fmiDoStep", "fmi2DoStep", "fmi3DoStep"},
    Names{Call::finish_step, "fmiDoStep, which returned fmiPending,", "fmi2DoStep, which returned fmi2Pending,",
          "fmi3DoStep"},
    Names{Call::terminate, "fmiTerminateSlave", "fmi2Terminate", "fmi3Terminate"},
    Names{Call::get_reals, "fmiGetReal", "fmi2GetReal", "fmi3GetFloat64"},
    Names{Call::get_integers, "fmiGetInteger", "fmi2GetInteger", "fmi3GetInt32 or its like"},
    Names{Call::get_booleans, "fmiGetBoolean", "fmi2GetBoolean", "fmi3GetBoolean"},
    Names{Call::get_strings, "fmiGetString", "fmi2GetString", "fmi3GetString"},
    common(Call::get_binaries, "fmi3GetBinary"),
    Names{Call::set_reals, "fmiSetReal", "fmi2SetReal", "fmi3SetFloat64"},
    Names{Call::set_integers, "fmiSetInteger", "fmi2SetInteger", "fmi3SetInt32 or its like"},
    Names{Call::set_booleans, "fmiSetBoolean", "fmi2SetBoolean", "fmi3SetBoolean"},
    Names{Call::set_strings, "fmiSetString", "fmi2SetString", "fmi3SetString"},
    common(Call::set_binaries, "fmi3SetBinary"),
    Names{Call::get_output_derivatives, "fmiGetRealOutputDerivatives", "fmi2GetRealOutputDerivatives",
          "fmi3GetOutputDerivatives"},
    Names{Call::set_input_derivatives, "fmiSetRealInputDerivatives", "fmi2SetRealInputDerivatives",
          "a call for derivatives of inputs"},
    Names{Call::save_state, "a call for states", "fmi2GetFMUstate", "fmi3GetFMUState"},
    Names{Call::restore_state, "a call for states", "fmi2SetFMUstate", "fmi3SetFMUState"},
    Names{Call::free_state, "a call for states", "fmi2FreeFMUstate", "fmi3FreeFMUState"},
    Names{Call::serialize, "a call for states", "fmi2SerializeFMUstate", "fmi3SerializeFMUState"},
    Names{Call::deserialize, "a call for states", "fmi2DeSerializeFMUstate", "fmi3DeserializeFMUState"},
    Names{Call::close, "fmiFreeSlaveInstance", "fmi2FreeInstance", "fmi3FreeInstance"},
    newer(Call::set_time, "fmi2SetTime", "fmi3SetTime"),
    newer(Call::get_states, "fmi2GetContinuousStates", "fmi3GetContinuousStates"),
    newer(Call::set_states, "fmi2SetContinuousStates", "fmi3SetContinuousStates"),
    newer(Call::get_derivatives, "fmi2GetDerivatives", "fmi3GetContinuousStateDerivatives"),
    newer(Call::get_indicators, "fmi2GetEventIndicators", "fmi3GetEventIndicators"),
    newer(Call::get_nominals, "fmi2GetNominalsOfContinuousStates", "fmi3GetNominalsOfContinuousStates"),
    newer(Call::get_outputs, "fmi2GetReal", "fmi3GetFloat64"),
    newer(Call::set_inputs, "fmi2SetReal", "fmi3SetFloat64"),
    newer(Call::enter_event_mode, "fmi2EnterEventMode", "fmi3EnterEventMode"),
    newer(Call::update_discrete_states, "fmi2NewDiscreteStates", "fmi3UpdateDiscreteStates"),
    newer(Call::enter_continuous_time_mode, "fmi2EnterContinuousTimeMode", "fmi3EnterContinuousTimeMode"),
    newer(Call::completed_step, "fmi2CompletedIntegratorStep", "fmi3CompletedIntegratorStep"),
    newer(Call::directional_derivatives, "fmi2GetDirectionalDerivative", "fmi3GetDirectionalDerivative"),
    common(Call::step_until, "fmi3DoStep"),
    common(Call::enter_step_mode, "fmi3EnterStepMode"),
    common(Call::ticks, "fmi3GetClock"),
    common(Call::tick, "fmi3SetClock"),
    common(Call::new_interval, "fmi3GetIntervalDecimal"),
    common(Call::shift, "fmi3GetShiftDecimal"),
};

}  // namespace

const char* name_of(Call call, std::string_view fmi_version) {
  const auto found = std::ranges::find(kNames, call, &Names::call);
  if (found == kNames.end()) return "an unknown call";  // the value in shared memory may be invalid
  if (fmi_version == "1.0") return found->fmi1;
  return fmi_version == "3.0" ? found->fmi3 : found->fmi2;
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
