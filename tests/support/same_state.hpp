// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/difference.hpp"

#include <gtest/gtest.h>

namespace mebots::test {

/// Whether two objects know the same, to the last bit; the first variable in which they differ when they do not.
template <state::Visited T>
testing::AssertionResult same_state(const T& one, const T& other) {
  if (state::save(one) == state::save(other)) return testing::AssertionSuccess();
  return testing::AssertionFailure() << state::first_difference(one, other)->text();
}

}  // namespace mebots::test
