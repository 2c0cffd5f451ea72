// SPDX-License-Identifier: Apache-2.0
// Counts heap allocations, including those of SUNDIALS in C, by replacing the C library's functions.
#include "support.hpp"

#include <cstddef>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)

namespace mebots::battery {
long allocations() {
  return -1;
}
}  // namespace mebots::battery

#else

namespace {
thread_local long count = 0;
}

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t number, std::size_t size);
void* __libc_realloc(void* pointer, std::size_t size);

__attribute__((visibility("default"))) void* malloc(std::size_t size) noexcept {
  ++count;
  return __libc_malloc(size);
}
__attribute__((visibility("default"))) void* calloc(std::size_t number, std::size_t size) noexcept {
  ++count;
  return __libc_calloc(number, size);
}
__attribute__((visibility("default"))) void* realloc(void* pointer, std::size_t size) noexcept {
  ++count;
  return __libc_realloc(pointer, size);
}
}

namespace mebots::battery {
long allocations() {
  return count;
}
}  // namespace mebots::battery

#endif
