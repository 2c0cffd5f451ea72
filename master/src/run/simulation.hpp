// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "message/ordered_messages.hpp"
#include "observer/observer.hpp"
#include "system/ensemble.hpp"

#include <atomic>
#include <cstdint>
#include <exception>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace mebots::master {

class StepPool;
class ThreadPolicy;

/// Why a run ended.
enum class EndReason { stop_time, stop_condition, terminated, interrupted };

struct End {
  EndReason reason = EndReason::stop_time;
  std::string text;  ///< one sentence for people
};

/// Everything that is needed to go on from a communication point, within the same process.
struct SimulationState {
  std::int64_t step = 0;
  std::vector<std::unique_ptr<SlaveState>> slaves;
  std::vector<std::byte> master;  ///< last values and observers
};

/// A run of an ensemble: fixed steps in whole nanoseconds, t_k = k h. Jacobi: at t_k every slave whose step
/// begins there takes its inputs as all outputs stood at t_k; then all step, so that the order of the instances
/// is nothing to the results. Gauss-Seidel: in the declared order each takes its inputs and steps, those before it
/// standing at t_k+1 already. In both, the order of the connections is nothing, and a slave with a longer step
/// shows its new outputs when the others reach its time, not before. With more than one thread slaves step at the same
/// time (Jacobi only) where measured times say that it pays; the results are the same bits.
class Simulation {
 public:
  /// `system` and `messages` must outlive the simulation.
  Simulation(const ResolvedSystem& system, MessageSink& messages, const SlaveOptions& options = {});
  ~Simulation();

  Ensemble& ensemble() { return ensemble_; }
  const Ensemble& ensemble() const { return ensemble_; }

  /// Observers are told of every communication point in the order in which they were added. Add them
  /// before initialize(); they must outlive the simulation's last step.
  void add(Observer& observer) { observers_.push_back(&observer); }

  /// To t = 0. Throws as Ensemble::initialize does.
  void initialize();

  /// Instead of initialize(): to where serialize() was called, in this process or another. Throws as both do.
  void resume(std::span<const std::byte> bytes);

  /// Takes one communication step. Returns false, and takes no step, when the end was reached: see end().
  bool step();

  /// Steps until the end. `interrupted` is looked at before every step.
  const End& run(const std::atomic<bool>& interrupted);

  bool ended() const { return ended_; }
  const End& end() const { return end_; }

  /// Tells the slaves that the run is over. A slave that went wrong must not be told.
  void terminate() { ensemble_.terminate(); }

  std::int64_t steps_done() const { return step_; }
  std::int64_t time_ns() const { return step_ * step_ns_; }

  /// Throws Error for a slave that cannot save its state.
  SimulationState save_state();
  /// Goes back (or forth) to where save_state() was called; observers follow.
  void restore_state(const SimulationState& state);
  /// A state as bytes, for another process that runs the same config with the same FMUs, and back.
  std::vector<std::byte> serialize(const SimulationState& state);
  SimulationState deserialize(std::span<const std::byte> bytes);

 private:
  void reach_point();
  bool step_slaves();
  bool step_jacobi();
  bool step_gauss_seidel();
  StepResult step_slave(std::size_t instance);
  StepResult finish_slave(std::size_t instance, StepResult result);
  void read_outputs_at(std::int64_t step, std::size_t instance);
  bool ended_by_slave();
  void step_in_parallel();
  void group_slaves();
  void finish(EndReason reason, std::string text);
  /// A division costs as much as a small FMU's step: most instances have the system's own step.
  bool begins_step(std::size_t instance, std::int64_t step) const {
    return multiples_[instance] == 1 || step % multiples_[instance] == 0;
  }

  const ResolvedSystem* system_;
  OrderedMessages messages_;  // before the slaves, which write to it
  Ensemble ensemble_;
  std::vector<Observer*> observers_;
  std::int64_t step_ns_;
  std::int64_t last_step_;
  std::vector<std::int64_t> multiples_;
  // Stepping at the same time; null with one thread.
  struct Attempt {
    StepResult result;
    std::exception_ptr error;
  };
  std::unique_ptr<ThreadPolicy> policy_;
  std::unique_ptr<StepPool> pool_;
  unsigned threads_ = 1;
  std::vector<std::vector<std::size_t>> groups_;  // each steps in order on one thread
  std::vector<Attempt> attempts_;                 // by instance

  std::vector<std::size_t> order_;  // Gauss-Seidel; empty = Jacobi
  const std::atomic<bool>* interrupted_;
  std::vector<std::pair<std::size_t, StepResult>> results_;  // of the step that is being taken
  std::int64_t step_ = 0;
  bool ended_ = false;
  End end_;
};

}  // namespace mebots::master
