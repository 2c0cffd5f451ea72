// SPDX-License-Identifier: Apache-2.0
// Defines the functions that the compiler calls for C++ objects. There is no heap, so that nothing can be deleted:
// operator delete traps, and the message about the trap contains the line of the call.
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
