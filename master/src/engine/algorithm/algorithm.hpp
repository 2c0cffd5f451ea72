// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/algorithm/slave_steps.hpp"
#include "message/ordered_messages.hpp"
#include "model/run_course.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace mebots::master {

/// Carries all slaves from one communication point to the next: who takes which inputs when, and who steps when.
/// To add one: a row in kAlgorithms (model/system_description.hpp), a class in a file of its own, a case in
/// registry.cpp.
class Algorithm {
 public:
  virtual ~Algorithm() = default;

  /// From t_k to t_(k+1). Afterwards the ensemble's outputs are those of t_(k+1), and nothing is returned. An end is
  /// returned when a slave gave up, and InterruptedError is thrown after an interrupt: then the outputs are still those
  /// of t_k, the last point that all reached. Throws what the slaves throw, too.
  virtual std::optional<End> step(std::int64_t k) = 0;
};

/// What an algorithm works on. All of it outlives the algorithm.
struct AlgorithmContext {
  const ResolvedSystem& system;
  SlaveSteps& slaves;
  OrderedMessages& messages;  ///< where the slaves' messages pass
};

/// Makes the one that the system's description names. Throws as find_algorithm() does.
std::unique_ptr<Algorithm> make_algorithm(const AlgorithmContext& context);

}  // namespace mebots::master
