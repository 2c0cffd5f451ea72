// SPDX-License-Identifier: Apache-2.0
#include "engine/algorithm/algorithm.hpp"

namespace mebots::master {

std::unique_ptr<Algorithm> make_algorithm(const AlgorithmContext& context) {
  switch (find_algorithm(context.system.description->algorithm).type) {
    case AlgorithmType::jacobi:
      return make_jacobi(context);
    case AlgorithmType::gauss_seidel:
      break;
  }
  return make_gauss_seidel(context);
}

}  // namespace mebots::master
