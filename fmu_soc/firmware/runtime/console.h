// SPDX-License-Identifier: Apache-2.0
// Prints text. Only the fabric controller may print: if a core of GAP8's cluster prints, it may never wake up.
#pragma once

#ifdef __cplusplus
extern "C" {
#endif

// Prints a text. Formats: %d (int32_t), %u and %x (uint32_t), %s, %c, %%. %m and %M print an int32_t as a decimal
// number with three digits: value / 1000 for %m, and value / 1000000 for %M. There is no floating point and no field
// width. An unknown letter is printed unchanged.
void print(const char* format, ...);

#ifdef __cplusplus
}
#endif
