// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/model_description.hpp"
#include "model/value_kind.hpp"

#include <cstddef>
#include <span>
#include <unordered_map>
#include <vector>

namespace mebots::master {

/// Replaces negated aliases of an FMI 1.0 FMU by the variables to which they refer, and changes the signs of their
/// values. Most FMUs have no negated aliases.
class NegatedValues {
 public:
  explicit NegatedValues(const modeldesc::ModelDescription& description);

  /// Returns the value references that the FMU uses for these variables. Returns `references` itself if no alias is
  /// negated. The result is valid until the next call.
  std::span<const ValueReference> in_fmu(std::span<const ValueReference> references);
  /// Calls negate(i) for each index i at which `references` contains a negated alias.
  template <typename Negate>
  void for_each_negated(std::span<const ValueReference> references, Negate negate) const {
    if (bases_.empty()) return;
    for (std::size_t i = 0; i < references.size(); ++i)
      if (bases_.contains(references[i])) negate(i);
  }

 private:
  std::unordered_map<ValueReference, ValueReference> bases_;  // maps a negated alias to the value reference in the FMU
  std::vector<ValueReference> references_;
};

}  // namespace mebots::master
