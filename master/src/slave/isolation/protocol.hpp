// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared_buffer.hpp"

#include <array>
#include <atomic>
#include <cstdint>
#include <string_view>

/// The protocol between master and host process. The master writes a batch of calls into a shared buffer; the host
/// executes them in order and writes the answers into another buffer. A batch contains all calls of a communication
/// step. Two counters define whether the master or the host may access the buffers.
namespace mebots::master::isolation {

enum class Call : std::uint32_t {
  none,
  open,
  setup_experiment,
  enter_initialization,
  exit_initialization,
  step,
  finish_step,
  terminate,
  get_reals,
  get_integers,
  get_booleans,
  get_strings,
  get_binaries,
  set_reals,
  set_integers,
  set_booleans,
  set_strings,
  set_binaries,
  get_output_derivatives,
  set_input_derivatives,
  save_state,
  restore_state,
  free_state,
  serialize,
  deserialize,
  close,
  unload,  // part of close: unload the library

  // of a ContinuousInstance
  set_time,
  get_states,
  set_states,
  get_derivatives,
  get_indicators,
  get_nominals,
  get_outputs,
  set_inputs,
  enter_event_mode,  // also of an EventInstance
  update_discrete_states,
  enter_continuous_time_mode,
  completed_step,
  directional_derivatives,

  // of an EventInstance
  step_until,
  enter_step_mode,

  // of a ClockInstance
  ticks,
  tick,
  new_interval,
  shift,
};

/// Returns the name of the call in a version of FMI: "1.0", "2.0" or "3.0".
const char* name_of(Call call, std::string_view fmi_version);

/// The outcome of a call; an answer starts with it.
enum class Answer : std::uint8_t { done, slave_error, input_error, error };

/// A counter that one process increments and the other waits for.
class Turn {
 public:
  std::uint32_t value() const { return value_.load(std::memory_order_acquire); }
  /// Increments the counter and wakes waiting processes.
  void pass();
  /// Waits until the value differs from `seen`: spins briefly, then sleeps, at most `timeout_ns`. Returns false at the
  /// timeout.
  bool wait(std::uint32_t seen, std::int64_t timeout_ns);

 private:
  std::atomic<std::uint32_t> value_{0};
  std::atomic<std::uint32_t> sleeping_{0};
};

/// The start of the control buffer. It is in shared memory, so it contains no pointers.
struct Control {
  Turn asked;     // incremented by the master: a batch is ready
  Turn answered;  // incremented by the host: the batch is done
  std::atomic<std::uint64_t> command_bytes{0};
  std::atomic<std::uint64_t> answer_bytes{0};
  std::atomic<std::uint64_t> log_bytes{0};  // complete messages so far, also of a batch that never ends
  std::atomic<Call> call{Call::none};       // the current or last call of the host
  std::atomic<std::uint32_t> calls{0};      // counts calls, so that each has its own deadline

  // Written by the host when a signal is about to end the process.
  std::atomic<std::uint32_t> fault_seen{0};
  std::atomic<std::uint64_t> fault_address{0};
  std::atomic<std::uint32_t> fault_on_stack{0};

  std::atomic<bool> cancel{false};  // set by the master: cancel the pending step
};
static_assert(std::atomic<std::uint64_t>::is_always_lock_free && std::atomic<bool>::is_always_lock_free);

/// The maximum size of the host's messages about one batch. The host may write anything to shared memory. A larger size
/// therefore shows the master that the host is faulty or hostile.
inline constexpr std::size_t kMostLogBytes = std::size_t{64} << 20;

/// Descriptors of a host process: control, commands, answers, log.
inline constexpr std::array<int, 4> kHostDescriptors = {3, 4, 5, 6};

}  // namespace mebots::master::isolation
