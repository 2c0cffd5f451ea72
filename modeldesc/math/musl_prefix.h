// SPDX-License-Identifier: Apache-2.0
// This text precedes the source of each mathematical function of musl, so that the source compiles with the headers of
// any C library. Requires GCC or Clang.
#define _GNU_SOURCE
#define __CRT__NO_INLINE 1  // MinGW defines some functions of float by those of double in its headers
#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdint.h>

// Replaces macros of musl's internal headers.
#define hidden
#define weak_alias(old, replacement) _Static_assert(1, "")
#ifndef __BYTE_ORDER
#define __BYTE_ORDER __BYTE_ORDER__
#define __LITTLE_ENDIAN __ORDER_LITTLE_ENDIAN__
#define __BIG_ENDIAN __ORDER_BIG_ENDIAN__
#endif

// Renames these functions, because glibc declares other functions with the same names.
#define __sin mebots_musl_sin
#define __cos mebots_musl_cos
#define __tan mebots_musl_tan
#define __sinl mebots_musl_sinl
#define __cosl mebots_musl_cosl
#define __tanl mebots_musl_tanl

// Rounds each operation, also on processors that could fuse a multiplication and an addition. musl would call fma() if
// these macros declared it fast.
#pragma GCC optimize("fp-contract=off")
#undef __FP_FAST_FMA
#undef __FP_FAST_FMAF

// Hides these functions, so that calls in a shared library do not reach functions of the same name in the program that
// loads the library.
#ifndef _WIN32
#pragma GCC visibility push(hidden)
#endif
