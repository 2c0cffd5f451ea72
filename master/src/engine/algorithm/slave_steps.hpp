// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/ensemble.hpp"
#include "model/run_course.hpp"
#include "slave/slave.hpp"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace mebots::master {

/// A communication step from t_from to t_to, where `from` and `to` are points of the grid. A step may be longer than
/// the grid's step h only under step control.
struct GridStep {
  std::int64_t from = 0;
  std::int64_t to = 0;
};

/// Steps the slaves on the grid of points t_k, for all algorithms. A slave's step is the communication step, or n times
/// the grid's step h if the config says so. A step of n times h starts at every n-th point. No communication step
/// extends past such a point.
class SlaveSteps {
 public:
  /// `system`, `ensemble` and `interrupted` must outlive this object.
  SlaveSteps(const ResolvedSystem& system, Ensemble& ensemble, const std::atomic<bool>& interrupted);

  Ensemble& ensemble() const { return *ensemble_; }
  std::size_t count() const { return steps_.size(); }
  std::int64_t time_ns(std::int64_t k) const { return grid_.time_ns(k); }
  /// Returns true if a step of the slave starts at t_k. If the multiple is 1, skips the division, which takes as long
  /// as a small FMU's step.
  bool begins_step(std::size_t slave, std::int64_t k) const {
    return steps_[slave].multiple == 1 || k % steps_[slave].multiple == 0;
  }

  /// Sets the slave's inputs to the ensemble's present values, if a step of the slave starts at t_k.
  void write_inputs(std::size_t slave, std::int64_t k);
  /// Performs the slave's step that starts at the start of this communication step. May be called for several slaves at
  /// the same time on different threads. After an interrupt, throws InterruptedError without calling the slave. Passes
  /// on exceptions of the slave.
  StepResult step(std::size_t slave, const GridStep& span);
  /// Waits until a pending step has finished. Throws SlaveError if the slave rejects the step.
  StepResult finish(std::size_t slave, const GridStep& span, StepResult result);
  /// Reads the slave's outputs at t_k, if a step of the slave ends at t_k.
  void read_outputs(std::size_t slave, std::int64_t k);

  /// Returns the reason why the run ends at t_k. Returns nullopt if the slave has finished its step.
  std::optional<End> end_of(std::size_t slave, std::int64_t k, const StepResult& result) const;

 private:
  SlaveError discarded(std::size_t slave, const GridStep& span, const StepResult& result) const;

  struct Step {
    std::int64_t multiple = 1;  // length of the step as a multiple of h; 1: the step is the communication step
    bool is_divided = false;    // true: if the slave discards the step, the step is divided into parts
  };

  const ResolvedSystem* system_;
  Ensemble* ensemble_;
  const std::atomic<bool>* interrupted_;
  TimeGrid grid_;
  std::vector<Step> steps_;  // by slave
};

/// Returns an End whose text is, for example, "interrupted at 3 s".
End interrupted_at(std::int64_t time_ns);

/// Advances the slave by one step. If the slave discards the step, restores the slave's state and tries a shorter step
/// up to the time that the slave reported. If the slave reported no time, tries half the step. Stops if a step of one
/// microsecond is discarded, or if the slave requests the end of the simulation. The slave must be able to save its
/// state. Passes on exceptions of the slave.
StepResult step_in_parts(Slave& slave, std::int64_t start_ns, std::int64_t duration_ns,
                         const std::atomic<bool>& cancel);

}  // namespace mebots::master
