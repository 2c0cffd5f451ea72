// SPDX-License-Identifier: Apache-2.0
// Kernels of GreenWaves' CNN benchmark of GAP8 (gap_sdk, benchmarks/gap8/cnn), new, written from what its README and
// its code say of them. A 5 x 5 convolution has 100 x 100 pixels of a byte (docs/chip/silicon.md tells why not
// 112 x 112), another one so many of a bit. The 2 x 2 pools have 112 x 112 pixels, the linear layer is 1024 to 16. Each
// is there in some of these forms of one result: plain RV32IMC, with Xpulp's scalar instructions, with its vectors of
// bytes. Of these kernels only powers are taken, and what is published stands for the cycles.
#pragma once

#include <stdint.h>

enum { kWidth = 100, kOut = kWidth - 4 };       // of convolutions: width and height
enum { kPixels = 112, kPooled = kPixels / 2 };  // of pools, likewise
enum { kInputs = 1024, kOutputs = 16, kTaps = 25 };

typedef struct {
  const int8_t* pixels;  // kWidth x kWidth, kPixels x kPixels or kInputs; of the xnor convolution, kWidth x kWidth bits
  const int8_t* weights;  // 28 of the convolution (kTaps, and three zeros), kTaps bits, or kOutputs x kInputs
  int32_t* sums;          // kOutputs
  int8_t* out;            // kOut x kOut, or kPooled x kPooled
  unsigned cores;
} job_t;

// What core `core` of `job->cores` does of the whole.
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
