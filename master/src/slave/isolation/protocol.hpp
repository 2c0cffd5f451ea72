// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared_buffer.hpp"

#include <array>
#include <atomic>
#include <cstdint>

/// What master and host process say to each other. The master writes a batch of calls into one shared buffer, the
/// host does them in order and writes the answers into another. One hand-over per batch, and a batch holds all that
/// a communication step needs. Which of the two works is a matter of two counters.
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
  unload,  // what close ends with: the library goes
};

/// The call as FMI names it.
const char* name_of(Call call);

/// How a call ended; an answer starts with it.
enum class Answer : std::uint8_t { done, slave_error, input_error, error };

/// A counter that one process raises and another waits for.
class Turn {
 public:
  std::uint32_t value() const { return value_.load(std::memory_order_acquire); }
  /// Raises the counter and wakes who sleeps for it.
  void pass();
  /// Waits for another value than `seen`, spinning for a moment and then asleep, at most `timeout_ns`.
  /// False when the time is up.
  bool wait(std::uint32_t seen, std::int64_t timeout_ns);

 private:
  std::atomic<std::uint32_t> value_{0};
  std::atomic<std::uint32_t> sleeping_{0};
};

/// The first bytes of the control buffer. Lies in shared memory: no pointers.
struct Control {
  Turn asked;     // raised by the master: a batch is ready
  Turn answered;  // raised by the host: the batch is done
  std::atomic<std::uint64_t> command_bytes{0};
  std::atomic<std::uint64_t> answer_bytes{0};
  std::atomic<std::uint64_t> log_bytes{0};  // whole messages so far, also of a batch that is never finished
  std::atomic<Call> call{Call::none};       // that the host is in, or was in last
  std::atomic<std::uint32_t> calls{0};      // counts them, so that each has its own deadline

  // Written by the host when a signal is about to end it.
  std::atomic<std::uint32_t> fault_seen{0};
  std::atomic<std::uint64_t> fault_address{0};
  std::atomic<std::uint32_t> fault_on_stack{0};

  std::atomic<bool> cancel{false};  // set by the master: the step that is pending is given up
};
static_assert(std::atomic<std::uint64_t>::is_always_lock_free && std::atomic<bool>::is_always_lock_free);

/// What the host says at most about one batch. All that lies in shared memory is the host's word: a master that finds
/// more than this has another host before it than ours.
inline constexpr std::size_t kMostLogBytes = std::size_t{64} << 20;

/// Descriptors of a host process: control, commands, answers, log.
inline constexpr std::array<int, 4> kHostDescriptors = {3, 4, 5, 6};

}  // namespace mebots::master::isolation
