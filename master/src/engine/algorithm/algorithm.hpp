// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/algorithm/slave_steps.hpp"
#include "message/message_hub.hpp"
#include "model/run_course.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace mebots::master {

/// Advances all slaves from one communication point to the next. Decides when each slave receives its inputs and when
/// it steps. To add an algorithm, add a row to kAlgorithms (model/system_description.hpp), a class in a new file, and a
/// case in registry.cpp.
class Algorithm {
 public:
  virtual ~Algorithm() = default;

  /// Performs one communication step. Returns nullopt if the run continues, and an End if a slave ends the run. Throws
  /// InterruptedError after an interrupt. Passes on the exceptions of slaves. After a completed step, the ensemble
  /// contains the outputs at the end of the step. After a returned End or InterruptedError, it still contains those at
  /// the start of the step.
  virtual std::optional<End> step(const GridStep& span) = 0;
};

/// The objects that an algorithm uses. They must outlive the algorithm.
struct AlgorithmContext {
  const ResolvedSystem& system;
  SlaveSteps& slaves;
  OrderedMessages& messages;
};

/// Creates the algorithm that the system's description names. Throws Error if the name is unknown.
std::unique_ptr<Algorithm> make_algorithm(const AlgorithmContext& context);

/// Creates the Jacobi algorithm. Every slave whose step starts at t_k receives the outputs of the others at t_k; then
/// all these slaves step. The order of the instances has no effect. If a slave has a longer step, its new outputs
/// become visible at the end of that step. With several threads, slaves step in parallel if measured times show a gain;
/// the results have the same bits.
std::unique_ptr<Algorithm> make_jacobi(const AlgorithmContext& context);

/// Creates the Gauss-Seidel algorithm: slaves step one after the other in the declared order. Each slave receives its
/// inputs just before its step. Inputs from earlier slaves are outputs at the end of the step, inputs from later slaves
/// outputs at the start. If a slave has a longer step, it steps in the first communication step of that longer step.
/// The master reads its outputs in the last communication step, so only slaves later in the order use the new outputs
/// in that step.
std::unique_ptr<Algorithm> make_gauss_seidel(const AlgorithmContext& context);

}  // namespace mebots::master
