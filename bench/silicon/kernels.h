// SPDX-License-Identifier: Apache-2.0
// Kernels of GreenWaves' CNN benchmark of GAP8 (gap_sdk, benchmarks/gap8/cnn), written from the description in its
// README and code. The convolution is 5 x 5 on 100 x 100 pixels of a byte (docs/chip/silicon.md explains why not 112 x
// 112), and the xnor convolution on the same number of bits. The pools are 2 x 2 on 112 x 112 pixels. The linear layer
// has 1024 inputs and 16 outputs. The forms of a kernel have the same result: plain RV32IMC, Xpulp's scalar
// instructions, Xpulp's vectors of bytes. Some kernels lack a form.
#pragma once

#include <stdint.h>

enum { kWidth = 100, kOut = kWidth - 4 };       // width and height of the pictures of convolutions
enum { kPixels = 112, kPooled = kPixels / 2 };  // width and height of the pictures of pools
enum { kInputs = 1024, kOutputs = 16, kTaps = 25 };

typedef struct {
  const int8_t* pixels;  // kWidth x kWidth, kPixels x kPixels or kInputs; of the xnor convolution, kWidth x kWidth bits
  const int8_t* weights;  // 28 of the convolution (kTaps, and three zeros), kTaps bits, or kOutputs x kInputs
  int32_t* sums;          // kOutputs sums
  int8_t* out;            // kOut x kOut or kPooled x kPooled bytes
  unsigned cores;
} job_t;

// Computes a core's part of the job. `core` is from 0 to `job->cores` - 1.
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
