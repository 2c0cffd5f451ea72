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

/// Contains everything that is needed to continue from a communication point in the same process.
struct SimulationState {
  std::int64_t step = 0;
  std::vector<std::unique_ptr<SlaveState>> slaves;
  std::vector<std::byte> master;  ///< the data of visit(): last values, step control, observers
  std::uint64_t layout = 0;       ///< hash of the structure of `master`
};

/// Performs a run over the points of a TimeGrid. An Algorithm steps the slaves from point to point. If the system has
/// step control, it chooses the points. Observers are called at every point. The class Run handles files and options.
class Simulation {
 public:
  /// `system`, `messages` and all objects in `options` must outlive the simulation.
  Simulation(const ResolvedSystem& system, MessageSink& messages, const SlaveOptions& options = {});
  ~Simulation();

  Ensemble& ensemble() { return ensemble_; }
  const Ensemble& ensemble() const { return ensemble_; }

  /// Adds an observer. Observers are called at every communication point, in the order in which they were added. Must
  /// be called before initialize(). The observer must exist until the last step of the simulation.
  void add(Observer& observer) { observers_.push_back(&observer); }

  /// Initialises the slaves and reaches the start time. Throws the errors of Ensemble::initialize(), and
  /// InterruptedError.
  void initialize();

  /// Continues from a state that serialize() converted, in this process or in another. Must be called instead of
  /// initialize(). Throws the same errors as initialize() and deserialize().
  void resume(std::span<const std::byte> bytes);

  /// Performs one communication step. Returns false and stays at the same point if the simulation has already ended, or
  /// if the step was not completed, for example because of an interrupt. end() states the reason.
  bool step();

  /// Performs steps until the simulation ends. Returns the reason.
  const End& run();

  bool ended() const { return ended_; }
  const End& end() const { return end_; }
  /// Ends the run at the current point.
  void finish(End end);

  /// Terminates all slaves that have not failed.
  void terminate() { ensemble_.terminate(); }
  /// Frees the instances. No slave may be called afterwards. Returns an error text for each slave that could not be
  /// freed.
  std::vector<std::string> free_instances() { return ensemble_.free_instances(); }

  /// Returns the number of communication steps that were performed so far.
  std::int64_t steps_done() const { return control_ ? control_->statistics().steps : step_; }
  /// Returns the index of the current point on the grid.
  std::int64_t grid_point() const { return step_; }
  /// Returns the statistics of step control. Returns null if every step has the same length.
  const StepStatistics* step_statistics() const { return control_ ? &control_->statistics() : nullptr; }
  std::int64_t time_ns() const { return grid_.time_ns(step_); }

  /// Returns the state at the current point. Throws Error if a slave cannot save its state.
  SimulationState save_state();
  /// Visits the master's part of the state: the values that were read or set last, step control, and the observers.
  void visit(state::Visitor& v);
  /// Restores a state that save_state() returned, including the states of observers.
  void restore_state(const SimulationState& state);
  /// serialize() converts a state to bytes, and deserialize() converts them back. The bytes are valid in every process
  /// that runs the same config with the same FMUs.
  std::vector<std::byte> serialize(const SimulationState& state);
  SimulationState deserialize(std::span<const std::byte> bytes);

 private:
  void reach_point();

  const std::atomic<bool>* interrupted_;
  OrderedMessages messages_;  // declared before the slaves, which send messages to it
  Ensemble ensemble_;
  SlaveSteps slaves_;
  std::unique_ptr<Algorithm> algorithm_;
  std::unique_ptr<StepControl> control_;  // null if every step has the length of the grid's step
  std::vector<Observer*> observers_;
  TimeGrid grid_;
  std::int64_t stop_ns_;
  std::int64_t step_ = 0;  // index of the current point on the grid
  bool ended_ = false;
  End end_;
};

}  // namespace mebots::master
