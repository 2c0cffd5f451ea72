// SPDX-License-Identifier: Apache-2.0
// What the compiler calls for C++ objects. There is no heap, so that nothing can be deleted; who does it all the same
// has a trap, which is told with the line that called.
#include <stddef.h>

extern "C" void __cxa_pure_virtual(void) {
  __builtin_trap();
}

void operator delete(void*) noexcept {
  __builtin_trap();
}

void operator delete(void*, size_t) noexcept {
  __builtin_trap();
}
