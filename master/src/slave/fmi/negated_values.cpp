// SPDX-License-Identifier: Apache-2.0
#include "slave/fmi/negated_values.hpp"

#include <algorithm>

namespace mebots::master {

NegatedValues::NegatedValues(const modeldesc::ModelDescription& description) {
  for (const auto& variable : description.variables)
    if (variable.negated_reference) bases_.emplace(variable.value_reference, *variable.negated_reference);
}

std::span<const ValueReference> NegatedValues::in_fmu(std::span<const ValueReference> references) {
  if (bases_.empty()) return references;
  references_.assign(references.begin(), references.end());
  for (auto& reference : references_) {
    const auto found = bases_.find(reference);
    if (found != bases_.end()) reference = found->second;
  }
  return references_;
}

}  // namespace mebots::master
