/* SPDX-License-Identifier: Apache-2.0 */
/* The functions of CMSIS-DSP that the firmware's Kalman filter calls, in plain C, so that a checkout without submodules
 * suffices. */
#pragma once

#include <math.h>
#include <stdint.h>
#include <string.h>

#ifndef PI
#define PI 3.14159265358979f
#endif

typedef float float32_t;
typedef enum { ARM_MATH_SUCCESS = 0 } arm_status;
typedef struct {
  uint16_t numRows;
  uint16_t numCols;
  float32_t* pData;
} arm_matrix_instance_f32;

static inline arm_status arm_mat_mult_f32(const arm_matrix_instance_f32* a, const arm_matrix_instance_f32* b,
                                          arm_matrix_instance_f32* out) {
  for (int i = 0; i < a->numRows; ++i) {
    for (int j = 0; j < b->numCols; ++j) {
      float32_t sum = 0.0f;
      for (int k = 0; k < a->numCols; ++k) sum += a->pData[i * a->numCols + k] * b->pData[k * b->numCols + j];
      out->pData[i * b->numCols + j] = sum;
    }
  }
  return ARM_MATH_SUCCESS;
}

static inline arm_status arm_mat_trans_f32(const arm_matrix_instance_f32* a, arm_matrix_instance_f32* out) {
  for (int i = 0; i < a->numRows; ++i) {
    for (int j = 0; j < a->numCols; ++j) out->pData[j * a->numRows + i] = a->pData[i * a->numCols + j];
  }
  return ARM_MATH_SUCCESS;
}

static inline arm_status arm_mat_scale_f32(const arm_matrix_instance_f32* a, float32_t by,
                                           arm_matrix_instance_f32* out) {
  for (int i = 0; i < a->numRows * a->numCols; ++i) out->pData[i] = by * a->pData[i];
  return ARM_MATH_SUCCESS;
}

static inline arm_status arm_sqrt_f32(float32_t x, float32_t* out) {
  *out = sqrtf(x);
  return ARM_MATH_SUCCESS;
}

static inline float32_t arm_cos_f32(float32_t x) {
  return cosf(x);
}

static inline float32_t arm_sin_f32(float32_t x) {
  return sinf(x);
}
