// SPDX-License-Identifier: Apache-2.0
// Kernels of GreenWaves' CNN benchmark of GAP8 (gap_sdk, benchmarks/gap8/cnn), new, written from what its README says
// of them: bytes, a 5 x 5 convolution and a 2 x 2 pool of 112 x 112 pixels, a linear layer of 1024 to 16. Each in forms
// of one result: plain RV32IMC, with Xpulp's scalar instructions, with its vectors of bytes.
// GreenWaves' own convolution has 100 x 100 pixels (docs/chip/silicon.md tells how that is known). Of these kernels
// only powers are taken, and what is published stands for the cycles.
#pragma once

#include <stdint.h>

enum { kWidth = 112, kOut = kWidth - 4, kPooled = kWidth / 2, kInputs = 1024, kOutputs = 16 };

typedef struct {
  const int8_t* pixels;   // kWidth x kWidth; of the linear layer, kInputs of them
  const int8_t* weights;  // 28 of the convolution (25, and three zeros), or kOutputs x kInputs
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
