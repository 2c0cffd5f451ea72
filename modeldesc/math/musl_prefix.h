// SPDX-License-Identifier: Apache-2.0
// This code precedes the code of each mathematical function of musl, so that it compiles with the headers of any C
// library. Requires GCC or Clang.
#define _GNU_SOURCE
#define __CRT__NO_INLINE 1  // MinGW defines some functions of float by those of double in its headers
#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdint.h>

// Replaces definitions of musl's internal headers.
#define hidden
#define weak_alias(old, replacement) _Static_assert(1, "")
#ifndef __BYTE_ORDER
#define __BYTE_ORDER __BYTE_ORDER__
#define __LITTLE_ENDIAN __ORDER_LITTLE_ENDIAN__
#define __BIG_ENDIAN __ORDER_BIG_ENDIAN__
#endif

// These names are replaced, because glibc declares other functions with the same names.
#define __sin mebots_musl_sin
#define __cos mebots_musl_cos
#define __tan mebots_musl_tan
#define __sinl mebots_musl_sinl
#define __cosl mebots_musl_cosl
#define __tanl mebots_musl_tanl

// Each operation is rounded, even on processors that could fuse a multiplication and an addition. musl calls fma() if
// it is fast.
#pragma GCC optimize("fp-contract=off")
#undef __FP_FAST_FMA
#undef __FP_FAST_FMAF

// In a shared library, calls must reach these functions, and not functions of the same name in the program that loads
// the library.
#ifndef _WIN32
#pragma GCC visibility push(hidden)
#endif
