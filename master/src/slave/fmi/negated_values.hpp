// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/model_description.hpp"
#include "model/value_kind.hpp"

#include <cstddef>
#include <span>
#include <unordered_map>
#include <vector>

namespace mebots::master {

/// The negated aliases of an FMU of FMI 1.0: their references, and the sign of their values. Most FMUs have none.
class NegatedValues {
 public:
  explicit NegatedValues(const modeldesc::ModelDescription& description);

  /// Returns the references that the FMU knows. Valid until the next call; `references` itself if no alias is negated.
  std::span<const ValueReference> in_fmu(std::span<const ValueReference> references);
  /// Calls negate(i) for each i whose reference is that of a negated alias.
  template <typename Negate>
  void for_each_negated(std::span<const ValueReference> references, Negate negate) const {
    if (bases_.empty()) return;
    for (std::size_t i = 0; i < references.size(); ++i)
      if (bases_.contains(references[i])) negate(i);
  }

 private:
  std::unordered_map<ValueReference, ValueReference> bases_;  // of each alias, the reference in the FMU
  std::vector<ValueReference> references_;
};

}  // namespace mebots::master
