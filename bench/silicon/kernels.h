// SPDX-License-Identifier: Apache-2.0
// Kernels of GreenWaves' CNN benchmark of GAP8 (gap_sdk, benchmarks/gap8/cnn), rewritten from the description in its
// README and code. A 5 x 5 convolution has 100 x 100 pixels of a byte (docs/chip/silicon.md explains why not 112 x
// 112). Another one has the same number of bits. The 2 x 2 pools have 112 x 112 pixels, the linear layer is 1024 to 16.
// Each kernel has some of these forms with the same result: plain RV32IMC, with Xpulp's scalar instructions, with its
// vectors of bytes. These kernels are used for power only; for cycles, the published values apply.
#pragma once

#include <stdint.h>

enum { kWidth = 100, kOut = kWidth - 4 };       // width and height of convolutions
enum { kPixels = 112, kPooled = kPixels / 2 };  // width and height of pools
enum { kInputs = 1024, kOutputs = 16, kTaps = 25 };

typedef struct {
  const int8_t* pixels;  // kWidth x kWidth, kPixels x kPixels or kInputs; of the xnor convolution, kWidth x kWidth bits
  const int8_t* weights;  // 28 of the convolution (kTaps, and three zeros), kTaps bits, or kOutputs x kInputs
  int32_t* sums;          // kOutputs
  int8_t* out;            // kOut x kOut, or kPooled x kPooled
  unsigned cores;
} job_t;

// Computes the share of core `core` among `job->cores` cores.
typedef void (*kernel_t)(const job_t* job, unsigned core);

void convolution_plain(const job_t* job, unsigned core);
void convolution_scalar(const job_t* job, unsigned core);
void convolution_vector(const job_t* job, unsigned core);
void linear_plain(const job_t* job, unsigned core);
void linear_scalar(const job_t* job, unsigned core);
void linear_vector(const job_t* job, unsigned core);
void pool_plain(const job_t* job, unsigned core);
void pool_scalar(const job_t* job, unsigned core);
void pool_vector(const job_t* job, unsigned core);
void average_scalar(const job_t* job, unsigned core);
void average_vector(const job_t* job, unsigned core);
void xnor_plain(const job_t* job, unsigned core);
void xnor_scalar(const job_t* job, unsigned core);
