// SPDX-License-Identifier: Apache-2.0
// Text out of the chip. For the fabric controller only: a core of GAP8's cluster that prints may sleep for ever.
#pragma once

#ifdef __cplusplus
extern "C" {
#endif

// Prints a text. Knows %d (int32_t), %u and %x (uint32_t), %s, %c, %%, and %m: an int32_t in thousandths or millionths
// printed as a decimal number, `%m` = value / 1000 with three digits, `%M` = value / 1000000 with three digits.
// No floating point, no width. An unknown letter is printed as it stands.
void print(const char* format, ...);

#ifdef __cplusplus
}
#endif
