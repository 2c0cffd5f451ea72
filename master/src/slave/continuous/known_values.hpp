// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"
#include "model/value_kind.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

namespace mebots::master {

/// The type of Integers, enumerations and Booleans in slaves.
using WholeNumber = std::int64_t;

/// Stores the last value of each variable of one kind to detect changes.
template <typename T>
class KnownValues {
 public:
  /// Stores a value. Returns true if the variable had no value or a different value.
  bool update(ValueReference reference, const T& value) {
    const auto found = std::ranges::lower_bound(references_, reference);
    const auto place = found - references_.begin();
    if (found == references_.end() || *found != reference) {
      references_.insert(found, reference);
      values_.insert(values_.begin() + place, value);
      return true;
    }
    auto& known = values_[static_cast<std::size_t>(place)];
    if (is_same(known, value)) return false;
    known = value;
    return true;
  }

  /// Returns the stored value of a variable; null if it has none.
  const T* find(ValueReference reference) const {
    const auto found = std::ranges::lower_bound(references_, reference);
    if (found == references_.end() || *found != reference) return nullptr;
    return &values_[static_cast<std::size_t>(found - references_.begin())];
  }

  void visit(state::Visitor& v) {
    v("references", references_);
    v("values", values_);
  }

 private:
  static bool is_same(const T& a, const T& b) {
    if constexpr (std::is_same_v<T, double>) {
      return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
    } else {
      return a == b;
    }
  }

  std::vector<ValueReference> references_;  // in ascending order
  std::vector<T> values_;
};

}  // namespace mebots::master
