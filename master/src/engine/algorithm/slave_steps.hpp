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

/// A communication step between two points of the grid. Without step control, a communication step spans one interval h
/// of the grid.
struct GridStep {
  std::int64_t from = 0;
  std::int64_t to = 0;
};

/// Steps the slaves between the points t_k of the grid, for all algorithms. A slave's step is one communication step,
/// or n intervals h of the grid if the config states n. A step of n intervals starts at every n-th point, and no
/// communication step extends past such a point.
class SlaveSteps {
 public:
  /// `system`, `ensemble` and `interrupted` must outlive this object.
  SlaveSteps(const ResolvedSystem& system, Ensemble& ensemble, const std::atomic<bool>& interrupted);

  Ensemble& ensemble() const { return *ensemble_; }
  std::size_t count() const { return steps_.size(); }
  std::int64_t time_ns(std::int64_t k) const { return grid_.time_ns(k); }
  /// Returns true if a step of the slave starts at t_k. The division takes as long as a step of a small FMU, so a
  /// multiple of 1 skips it.
  bool begins_step(std::size_t slave, std::int64_t k) const {
    return steps_[slave].multiple == 1 || k % steps_[slave].multiple == 0;
  }

  /// If a step of the slave starts at t_k, sets its inputs to the latest values of the connected outputs.
  void write_inputs(std::size_t slave, std::int64_t k);
  /// Performs the slave's step that starts at `span.from`. Different threads may step different slaves at the same
  /// time. After an interrupt, throws InterruptedError without calling the slave. Passes on exceptions of the slave.
  StepResult step(std::size_t slave, const GridStep& span);
  /// Waits for the end of a pending step. Throws SlaveError if the slave discards the step.
  StepResult finish(std::size_t slave, const GridStep& span, StepResult result);
  /// If a step of the slave ends at t_k, reads the slave's outputs.
  void read_outputs(std::size_t slave, std::int64_t k);

  /// Returns the reason why the run ends at t_k. Returns nullopt if the slave has completed its step.
  std::optional<End> end_of(std::size_t slave, std::int64_t k, const StepResult& result) const;

 private:
  SlaveError discarded(std::size_t slave, const GridStep& span, const StepResult& result) const;

  struct Step {
    std::int64_t multiple = 1;  // length of the step in intervals h; if 1, the step is one communication step
    bool is_divided = false;    // true if a discarded step is repeated in parts
  };

  const ResolvedSystem* system_;
  Ensemble* ensemble_;
  const std::atomic<bool>* interrupted_;
  TimeGrid grid_;
  std::vector<Step> steps_;  // by slave
};

/// Returns an End with a text such as "interrupted at 3 s".
End interrupted_at(std::int64_t time_ns);

/// Advances the slave by one step. If the slave discards the step, restores the slave's state and tries a shorter step:
/// up to the time that the slave reported, otherwise half the step. Stops if a step of one microsecond is discarded, or
/// if the slave requests the end of the run. The slave must be able to save its state. Passes on exceptions of the
/// slave.
StepResult step_in_parts(Slave& slave, std::int64_t start_ns, std::int64_t duration_ns,
                         const std::atomic<bool>& cancel);

}  // namespace mebots::master
