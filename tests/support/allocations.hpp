// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace mebots::test {

/// How often the program has asked operator new for memory, on all threads.
long allocations();

}  // namespace mebots::test
