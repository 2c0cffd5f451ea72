// SPDX-License-Identifier: Apache-2.0
// Prints text. Only the fabric controller may print: a core of GAP8's cluster that prints may never wake up.
#pragma once

#ifdef __cplusplus
extern "C" {
#endif

// Prints a text. Formats: %d (int32_t), %u and %x (uint32_t), %s, %c, %%. %m and %M print an int32_t divided by 1000 or
// 1000000, with three decimals. There is no floating point and no field width. An unknown format is printed unchanged.
void print(const char* format, ...);

#ifdef __cplusplus
}
#endif
