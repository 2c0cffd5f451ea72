// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace mebots::test {

/// Returns the number of calls of operator new on all threads.
long allocations();

}  // namespace mebots::test
