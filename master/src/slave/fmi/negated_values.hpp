// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/model_description.hpp"
#include "model/value_kind.hpp"

#include <cstddef>
#include <span>
#include <unordered_map>
#include <vector>

namespace mebots::master {

/// Replaces negated aliases in FMUs of FMI 1.0 by their base variables, whose values have the opposite sign.
class NegatedValues {
 public:
  explicit NegatedValues(const modeldesc::ModelDescription& description);

  /// Returns the value references that the FMU uses. If `references` contains no negated alias, returns `references`
  /// itself. The result is valid until the next call.
  std::span<const ValueReference> in_fmu(std::span<const ValueReference> references);
  /// Calls negate(i) for each negated alias references[i].
  template <typename Negate>
  void for_each_negated(std::span<const ValueReference> references, Negate negate) const {
    if (bases_.empty()) return;
    for (std::size_t i = 0; i < references.size(); ++i)
      if (bases_.contains(references[i])) negate(i);
  }

 private:
  std::unordered_map<ValueReference, ValueReference> bases_;  // key: negated alias; value: base variable
  std::vector<ValueReference> references_;
};

}  // namespace mebots::master
