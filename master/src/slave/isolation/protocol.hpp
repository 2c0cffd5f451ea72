// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared_buffer.hpp"

#include <array>
#include <atomic>
#include <cstdint>
#include <string_view>

/// Defines the protocol between the master and a host process. The master writes a batch of calls into a shared buffer.
/// The host executes them in order and writes the answers into another buffer. Two counters determine which process may
/// access the buffers.
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
  unload,  // unloads the library; part of close

  // Calls of ContinuousInstance.
  set_time,
  get_states,
  set_states,
  get_derivatives,
  get_indicators,
  get_nominals,
  get_outputs,
  set_inputs,
  enter_event_mode,  // also a call of EventInstance
  update_discrete_states,
  enter_continuous_time_mode,
  completed_step,
  directional_derivatives,

  // Calls of EventInstance.
  step_until,
  enter_step_mode,

  // Calls of ClockInstance.
  ticks,
  tick,
  new_interval,
  shift,
};

/// Returns the FMI function that implements the call in a version of FMI: "1.0", "2.0" or "3.0".
const char* name_of(Call call, std::string_view fmi_version);

/// The outcome of a call, at the start of every answer.
enum class Answer : std::uint8_t { done, slave_error, input_error, error };

/// A counter in shared memory. One process increments it, and the other process waits for the change.
class Turn {
 public:
  std::uint32_t value() const { return value_.load(std::memory_order_acquire); }
  /// Increments the counter and wakes the waiting process.
  void pass();
  /// Waits until the value differs from `seen`. Spins for a short time, then sleeps. Returns false after `timeout_ns`.
  bool wait(std::uint32_t seen, std::int64_t timeout_ns);

 private:
  std::atomic<std::uint32_t> value_{0};
  std::atomic<std::uint32_t> sleeping_{0};
};

/// The start of the control buffer. Must not contain pointers, because the processes may map it at different addresses.
struct Control {
  Turn asked;     // the master increments it after writing a batch
  Turn answered;  // the host increments it after executing the batch
  std::atomic<std::uint64_t> command_bytes{0};
  std::atomic<std::uint64_t> answer_bytes{0};
  std::atomic<std::uint64_t> log_bytes{0};  // size of all complete messages, also if the batch does not end
  std::atomic<Call> call{Call::none};       // current or last call of the host
  std::atomic<std::uint32_t> calls{0};      // number of calls; each call has its own deadline

  // The host writes these members before a signal ends the process.
  std::atomic<std::uint32_t> fault_seen{0};
  std::atomic<std::uint64_t> fault_address{0};
  std::atomic<std::uint32_t> fault_on_stack{0};

  std::atomic<bool> cancel{false};  // the master sets it to cancel the pending step
};
static_assert(std::atomic<std::uint64_t>::is_always_lock_free && std::atomic<bool>::is_always_lock_free);

/// The maximum size of the host's messages in one batch. A larger size means that the host is faulty or hostile.
inline constexpr std::size_t kMostLogBytes = std::size_t{64} << 20;

/// The file descriptors of a host process for the buffers of control, commands, answers and log.
inline constexpr std::array<int, 4> kHostDescriptors = {3, 4, 5, 6};

}  // namespace mebots::master::isolation
