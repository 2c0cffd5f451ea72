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

/// Advances all slaves from one communication point to the next: decides when each slave receives its inputs and when
/// it steps. To add an algorithm, add a row in kAlgorithms (model/system_description.hpp), a class in a new file, and a
/// case in registry.cpp.
class Algorithm {
 public:
  virtual ~Algorithm() = default;

  /// Performs one communication step. Afterwards, the ensemble's outputs are those at the end of the step. Returns
  /// nullopt if the run continues, and an End if a slave ends the simulation. After an interrupt, throws
  /// InterruptedError. In these two cases, the outputs are still those at the start of the step, the last point that
  /// all slaves have reached. Exceptions of slaves are passed on.
  virtual std::optional<End> step(const GridStep& span) = 0;
};

/// The objects that an algorithm uses. They must outlive the algorithm.
struct AlgorithmContext {
  const ResolvedSystem& system;
  SlaveSteps& slaves;
  OrderedMessages& messages;  ///< receives the slaves' messages
};

/// Creates the algorithm named in the system's description. Throws as find_algorithm() does.
std::unique_ptr<Algorithm> make_algorithm(const AlgorithmContext& context);

/// Jacobi: at t_k, every slave whose step starts there receives its inputs from all outputs at t_k. Then all these
/// slaves step. Therefore the order of the instances has no effect. The new outputs of a slave with a longer step
/// become visible when the others reach its time. With several threads, slaves step in parallel if measured times show
/// a gain; the results have the same bits.
std::unique_ptr<Algorithm> make_jacobi(const AlgorithmContext& context);

/// Gauss-Seidel: the slaves step one after the other in the declared order. Each slave receives its inputs just before
/// its step: outputs at the end of the step from earlier slaves, outputs at its start from later slaves. A slave with a
/// longer step steps in the last of the other slaves' steps that lie within its own step. Its new outputs are visible
/// to the slaves after it.
std::unique_ptr<Algorithm> make_gauss_seidel(const AlgorithmContext& context);

}  // namespace mebots::master
