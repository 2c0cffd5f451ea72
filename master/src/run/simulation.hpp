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

/// The state of a simulation at a communication point, for use in the same process.
struct SimulationState {
  std::int64_t step = 0;
  std::vector<std::unique_ptr<SlaveState>> slaves;
  std::vector<std::byte> master;  ///< data of Simulation::visit()
  std::uint64_t layout = 0;       ///< hash of the structure of `master`
};

/// Runs a system over the points of a TimeGrid. An Algorithm steps the slaves from point to point. If the system has
/// step control, step control chooses the points. Files and options are the task of the class Run.
class Simulation {
 public:
  /// `system`, `messages` and all objects in `options` must outlive the simulation.
  Simulation(const ResolvedSystem& system, MessageSink& messages, const SlaveOptions& options = {});
  ~Simulation();

  Ensemble& ensemble() { return ensemble_; }
  const Ensemble& ensemble() const { return ensemble_; }

  /// Adds an observer, which is called at every communication point in the order of the add() calls. Must be called
  /// before initialize(). The observer must exist until the last step.
  void add(Observer& observer) { observers_.push_back(&observer); }

  /// Initialises the slaves at the start time. Throws the errors of Ensemble::initialize().
  void initialize();

  /// Continues from bytes that serialize() returned, in this or another process. Must be called instead of
  /// initialize(). Throws the errors of initialize() and deserialize().
  void resume(std::span<const std::byte> bytes);

  /// Performs one communication step. If the simulation has ended, or the step could not be completed, returns false
  /// and stays at the same point. Then end() states the reason.
  bool step();

  /// Steps until the simulation ends. Returns the reason.
  const End& run();

  bool ended() const { return ended_; }
  const End& end() const { return end_; }
  void finish(End end);

  /// Terminates all slaves that have not failed.
  void terminate() { ensemble_.terminate(); }
  /// Frees the instances. Slaves must not be called afterwards. Returns one error text per slave that could not be
  /// freed.
  std::vector<std::string> free_instances() { return ensemble_.free_instances(); }

  std::int64_t steps_done() const { return control_ ? control_->statistics().steps : step_; }
  /// Returns the index of the current point on the grid.
  std::int64_t grid_point() const { return step_; }
  /// Returns the statistics of step control. Null without step control.
  const StepStatistics* step_statistics() const { return control_ ? &control_->statistics() : nullptr; }
  std::int64_t time_ns() const { return grid_.time_ns(step_); }

  /// Returns the state at the current point. Throws Error if a slave cannot save its state.
  SimulationState save_state();
  /// Visits the master's part of the state: outputs and inputs, step control and observers.
  void visit(state::Visitor& v);
  /// Restores a state that save_state() returned, including observers.
  void restore_state(const SimulationState& state);
  /// Convert a state to bytes and back. The bytes are valid in every process that runs the same config with the same
  /// FMUs.
  std::vector<std::byte> serialize(const SimulationState& state);
  SimulationState deserialize(std::span<const std::byte> bytes);

 private:
  void reach_point();

  const std::atomic<bool>* interrupted_;
  OrderedMessages messages_;  // declared before the slaves, which send messages to this object
  Ensemble ensemble_;
  SlaveSteps slaves_;
  std::unique_ptr<Algorithm> algorithm_;
  std::unique_ptr<StepControl> control_;  // null without step control
  std::vector<Observer*> observers_;
  TimeGrid grid_;
  std::int64_t stop_ns_;
  std::int64_t step_ = 0;  // index of the current point on the grid
  bool ended_ = false;
  End end_;
};

}  // namespace mebots::master
