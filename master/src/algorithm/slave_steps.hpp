// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "run/end.hpp"
#include "system/ensemble.hpp"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace mebots::master {

/// The slaves on the grid of communication points t_k: what every algorithm is made of. A slave may step on a
/// multiple of h; its own steps begin at every so many points.
class SlaveSteps {
 public:
  /// `system` and `ensemble` must outlive this object, and so must `interrupted`.
  SlaveSteps(const ResolvedSystem& system, Ensemble& ensemble, const std::atomic<bool>& interrupted);

  Ensemble& ensemble() const { return *ensemble_; }
  std::size_t count() const { return multiples_.size(); }
  std::int64_t time_ns(std::int64_t k) const { return grid_.time_ns(k); }
  /// A division costs as much as a small FMU's step: most slaves have the system's own step.
  bool begins_step(std::size_t slave, std::int64_t k) const {
    return multiples_[slave] == 1 || k % multiples_[slave] == 0;
  }

  /// Hands the slave its inputs as the ensemble has them now, if a step of it begins at t_k.
  void write_inputs(std::size_t slave, std::int64_t k);
  /// Takes the slave's step that begins at t_k. Slaves that share nothing may do so at the same time, each on a
  /// thread. Throws InterruptedError before the call, and what the slave throws.
  StepResult step(std::size_t slave, std::int64_t k);
  /// Waits for a step that is pending. Throws SlaveError for one that the slave refused.
  StepResult finish(std::size_t slave, std::int64_t k, StepResult result);
  /// Reads the slave's outputs at t_k, if a step of it ends there.
  void read_outputs(std::size_t slave, std::int64_t k);

  /// Why the run ends at t_k when the slave did not finish its step; nothing when it did.
  std::optional<End> end_of(std::size_t slave, std::int64_t k, const StepResult& result) const;

 private:
  const ResolvedSystem* system_;
  Ensemble* ensemble_;
  const std::atomic<bool>* interrupted_;
  TimeGrid grid_;
  std::vector<std::int64_t> multiples_;
};

/// "interrupted at 3 s"
End interrupted_at(std::int64_t time_ns);

}  // namespace mebots::master
