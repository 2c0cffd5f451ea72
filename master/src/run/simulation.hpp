// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/algorithm/algorithm.hpp"
#include "engine/algorithm/slave_steps.hpp"
#include "engine/ensemble.hpp"
#include "engine/step_control/step_control.hpp"
#include "message/message_hub.hpp"
#include "model/run_course.hpp"
#include "record/observer.hpp"

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace mebots::master {

/// Everything needed to continue from a communication point in the same process.
struct SimulationState {
  std::int64_t step = 0;
  std::vector<std::unique_ptr<SlaveState>> slaves;
  std::vector<std::byte> master;  ///< last values and observers
  std::uint64_t layout = 0;       ///< hash of the layout of `master`
};

/// The loop of a run over the points of a TimeGrid. An Algorithm steps the slaves from point to point. StepControl, if
/// the system has it, chooses the points. Observers are called at every point. Files and options belong to Run.
class Simulation {
 public:
  /// `system`, `messages` and all objects in `options` must outlive the simulation.
  Simulation(const ResolvedSystem& system, MessageSink& messages, const SlaveOptions& options = {});
  ~Simulation();

  Ensemble& ensemble() { return ensemble_; }
  const Ensemble& ensemble() const { return ensemble_; }

  /// Adds an observer, which is called at every communication point in the order of addition. Must be called before
  /// initialize(). The observer must outlive the simulation's last step.
  void add(Observer& observer) { observers_.push_back(&observer); }

  /// Advances to the start time. Throws the errors of Ensemble::initialize, and InterruptedError.
  void initialize();

  /// Restores a state that serialize() wrote in this process or another. Replaces the call of initialize(). Throws the
  /// same errors as initialize() and deserialize().
  void resume(std::span<const std::byte> bytes);

  /// Takes one communication step. Returns false and stays at the same point if the simulation had already ended. Does
  /// the same if the step was not completed, for example because of an interrupt. end() returns the reason.
  bool step();

  /// Steps until the end.
  const End& run();

  bool ended() const { return ended_; }
  const End& end() const { return end_; }
  /// Ends the run at the present point.
  void finish(End end);

  /// Terminates the slaves that have not failed.
  void terminate() { ensemble_.terminate(); }
  /// Frees the instances. No slave may be called afterwards. Returns an error text for each slave that failed.
  std::vector<std::string> free_instances() { return ensemble_.free_instances(); }

  /// Returns the number of communication steps so far.
  std::int64_t steps_done() const { return control_ ? control_->statistics().steps : step_; }
  /// Returns the index of the present point on the grid.
  std::int64_t grid_point() const { return step_; }
  /// Returns the statistics of step control; null if every step has the same length.
  const StepStatistics* step_statistics() const { return control_ ? &control_->statistics() : nullptr; }
  std::int64_t time_ns() const { return grid_.time_ns(step_); }

  /// Returns the state. Throws Error if a slave cannot save its state.
  SimulationState save_state();
  /// Visits the master's own part of save_state(): last values and observers.
  void visit(state::Visitor& v);
  /// Restores a state that save_state() returned, including the states of the observers.
  void restore_state(const SimulationState& state);
  /// serialize() converts a state to bytes, and deserialize() converts the bytes to a state. The bytes are valid in any
  /// process that runs the same config with the same FMUs.
  std::vector<std::byte> serialize(const SimulationState& state);
  SimulationState deserialize(std::span<const std::byte> bytes);

 private:
  void reach_point();

  const std::atomic<bool>* interrupted_;
  OrderedMessages messages_;  // before the slaves, which send messages to it
  Ensemble ensemble_;
  SlaveSteps slaves_;
  std::unique_ptr<Algorithm> algorithm_;
  std::unique_ptr<StepControl> control_;  // null: every step has the length of the grid's
  std::vector<Observer*> observers_;
  TimeGrid grid_;
  std::int64_t stop_ns_;
  std::int64_t step_ = 0;  // place on the grid
  bool ended_ = false;
  End end_;
};

}  // namespace mebots::master
