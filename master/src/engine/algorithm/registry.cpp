// SPDX-License-Identifier: Apache-2.0
// The algorithms that a config can name, one row each.
#include "engine/algorithm/gauss_seidel.hpp"
#include "engine/algorithm/jacobi.hpp"
#include "mebots/input_error.hpp"
#include "mebots/nearest_names.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace mebots::master {
namespace {

constexpr AlgorithmKind kAlgorithms[] = {
    {.name = "jacobi", .takes_order = false, .make = &make_jacobi},
    {.name = "gauss-seidel", .takes_order = true, .make = &make_gauss_seidel},
};

}  // namespace

const AlgorithmKind& find_algorithm(const AlgorithmDescription& description) {
  const auto* found = std::ranges::find(kAlgorithms, description.type, &AlgorithmKind::name);
  if (found == std::end(kAlgorithms)) {
    std::vector<std::string> names;
    for (const auto& kind : kAlgorithms) names.emplace_back(kind.name);
    throw InputError(ErrorCode::unknown_name,
                     fmt::format("there is no algorithm '{}'. {}", description.type, suggest(description.type, names)));
  }
  if (!found->takes_order && !description.order.empty()) {
    throw InputError(ErrorCode::invalid_value,
                     fmt::format("'{}' steps all instances on the same values, so it takes no order", found->name));
  }
  return *found;
}

}  // namespace mebots::master
