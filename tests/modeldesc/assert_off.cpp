// SPDX-License-Identifier: Apache-2.0
// Tests assertions as in the preset release, in builds of any preset.
#undef MEBOTS_ASSERTIONS
#include "mebots/assert.hpp"

namespace mebots::test {

int unchecked_half(int number, int& evaluations) {
  const bool is_even = number % 2 == 0;  // no warning, although only the assertion uses it
  MEBOTS_ASSERT(++evaluations > 0 && is_even, "only even numbers");
  return number / 2;
}

}  // namespace mebots::test
