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
/// the slave steps. To add an algorithm, add a row in kAlgorithms (model/system_description.hpp), a class in a new
/// file, and a case in registry.cpp.
class Algorithm {
 public:
  virtual ~Algorithm() = default;

  /// Performs one communication step. Returns nullopt if the run continues, and an End if a slave ends the simulation.
  /// Throws InterruptedError after an interrupt, and the exceptions of slaves. After the step, the ensemble's outputs
  /// are those at the end of the step. If the function returns an End or throws InterruptedError, the outputs are still
  /// those at the start of the step, which is the last point that all slaves have reached.
  virtual std::optional<End> step(const GridStep& span) = 0;
};

/// References to the objects that an algorithm uses. The objects must outlive the algorithm.
struct AlgorithmContext {
  const ResolvedSystem& system;
  SlaveSteps& slaves;
  OrderedMessages& messages;  ///< receives the slaves' messages
};

/// Creates the algorithm that the system's description names. Throws Error, as find_algorithm() does, if the name is
/// unknown.
std::unique_ptr<Algorithm> make_algorithm(const AlgorithmContext& context);

/// The Jacobi algorithm: every slave whose step starts at t_k receives its inputs from the outputs at t_k. After that,
/// all these slaves step. Therefore the order of the instances has no effect. The new outputs of a slave with a longer
/// step become visible when the other slaves reach the end of this step. With several threads, slaves step in parallel
/// if measured times show a gain; the results have the same bits.
std::unique_ptr<Algorithm> make_jacobi(const AlgorithmContext& context);

/// The Gauss-Seidel algorithm: the slaves step one after the other in the declared order. Each slave receives its
/// inputs just before its step. Slaves before it in the order provide outputs at the end of the step, slaves after it
/// outputs at the start. If a slave has a longer step, it steps in the first communication step within this longer
/// step. Its new outputs are read at its turn in the last one, and are visible to the slaves after it in the order.
std::unique_ptr<Algorithm> make_gauss_seidel(const AlgorithmContext& context);

}  // namespace mebots::master
