// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/difference.hpp"

#include <gtest/gtest.h>

namespace mebots::test {

/// True if two objects have the same state, bit for bit. Otherwise, the message contains the first different variable.
template <state::Visited T>
testing::AssertionResult same_state(const T& one, const T& other) {
  if (state::save(one) == state::save(other)) return testing::AssertionSuccess();
  return testing::AssertionFailure() << state::first_difference(one, other)->text();
}

}  // namespace mebots::test
