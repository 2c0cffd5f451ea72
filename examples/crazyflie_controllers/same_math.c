// SPDX-License-Identifier: Apache-2.0
// Mathematical functions that use only +, -, *, / and sqrt of doubles. Therefore they have the same bits on every
// machine. Their accuracy is about 1e-7, which suffices: the checksums of chip and host must only agree.
#include <math.h>
#include <stdint.h>

static const double kPi = 3.14159265358979323846;

static double sine(double x) {
  x -= 2.0 * kPi * (double)(int64_t)(x / (2.0 * kPi) + (x < 0.0 ? -0.5 : 0.5));
  double term = x;
  double sum = x;
  for (int n = 1; n < 16; ++n) {
    term *= -x * x / (2 * n * (2 * n + 1));
    sum += term;
  }
  return sum;
}

// Halves the angle three times, so that the series converges quickly.
static double arc_tangent(double x) {
  for (int i = 0; i < 3; ++i) x = x / (1.0 + sqrt(1.0 + x * x));
  double power = x;
  double sum = x;
  for (int n = 1; n < 16; ++n) {
    power *= -x * x;
    sum += power / (2 * n + 1);
  }
  return 8.0 * sum;
}

static double arc_tangent_of(double y, double x) {
  if (x > 0.0) return arc_tangent(y / x);
  if (x < 0.0) return arc_tangent(y / x) + (y < 0.0 ? -kPi : kPi);
  return y > 0.0 ? 0.5 * kPi : y < 0.0 ? -0.5 * kPi : 0.0;
}

float sinf(float x) {
  return (float)sine(x);
}
float cosf(float x) {
  return (float)sine(x + 0.5 * kPi);
}
float atan2f(float y, float x) {
  return (float)arc_tangent_of(y, x);
}
float asinf(float x) {
  return (float)arc_tangent_of(x, sqrt(1.0 - (double)x * x));
}
float acosf(float x) {
  return (float)arc_tangent_of(sqrt(1.0 - (double)x * x), x);
}
// Computes squares. For other exponents, which the controllers do not use, returns NaN.
float powf(float x, float y) {
  return y == 2.0F ? x * x : NAN;
}
