// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/algorithm/algorithm.hpp"

namespace mebots::master {

/// The slaves step one after the other in the declared order. Each takes its inputs just before: from those before it
/// as they stand at t_(k+1), from those after it as at t_k. A slave with a longer step shows its new outputs at its
/// turn in the step in which the others reach its time.
std::unique_ptr<Algorithm> make_gauss_seidel(const AlgorithmContext& context);

}  // namespace mebots::master
