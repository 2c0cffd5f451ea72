// SPDX-License-Identifier: Apache-2.0
// Implements the memory functions that compilers call in freestanding code.
#include <stddef.h>
#include <stdint.h>

void* memcpy(void* restrict to, const void* restrict from, size_t size);
void* memmove(void* to, const void* from, size_t size);
void* memset(void* to, int value, size_t size);
int memcmp(const void* a, const void* b, size_t size);

void* memcpy(void* restrict to, const void* restrict from, size_t size) {
  uint8_t* t = to;
  const uint8_t* f = from;
  if ((((uintptr_t)t | (uintptr_t)f) & 3) == 0) {
    for (; size >= 4; size -= 4, t += 4, f += 4) {
      *(uint32_t*)t = *(const uint32_t*)f;
    }
  }
  while (size-- > 0) {
    *t++ = *f++;
  }
  return to;
}

void* memmove(void* to, const void* from, size_t size) {
  uint8_t* t = to;
  const uint8_t* f = from;
  if (t < f) {
    while (size-- > 0) {
      *t++ = *f++;
    }
  } else {
    while (size-- > 0) {
      t[size] = f[size];
    }
  }
  return to;
}

void* memset(void* to, int value, size_t size) {
  uint8_t* t = to;
  while (size-- > 0) {
    *t++ = (uint8_t)value;
  }
  return to;
}

int memcmp(const void* a, const void* b, size_t size) {
  const uint8_t* x = a;
  const uint8_t* y = b;
  for (; size > 0; --size, ++x, ++y) {
    if (*x != *y) {
      return *x < *y ? -1 : 1;
    }
  }
  return 0;
}
