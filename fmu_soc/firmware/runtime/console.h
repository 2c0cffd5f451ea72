// SPDX-License-Identifier: Apache-2.0
// Text output. Only for the fabric controller: if a core of GAP8's cluster prints, it may never wake up.
#pragma once

#ifdef __cplusplus
extern "C" {
#endif

// Prints a text. Formats: %d (int32_t), %u and %x (uint32_t), %s, %c, %%, and %m and %M: an int32_t as a decimal number
// with three digits, `%m` = value / 1000, `%M` = value / 1000000. No floating point, no width. An unknown letter is
// printed unchanged.
void print(const char* format, ...);

#ifdef __cplusplus
}
#endif
