// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/algorithm/algorithm.hpp"

namespace mebots::master {

/// At t_k every slave whose step begins there takes its inputs as all outputs stood at t_k; then all step. So the order
/// of the instances is nothing to the results. A slave with a longer step shows its new outputs when the others reach
/// its time, not before. With more than one thread slaves step at the same time where measured times say that it pays;
/// the results are the same bits.
std::unique_ptr<Algorithm> make_jacobi(const AlgorithmContext& context);

}  // namespace mebots::master
