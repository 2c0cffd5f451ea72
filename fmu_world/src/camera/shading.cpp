// SPDX-License-Identifier: Apache-2.0
#include "camera/shading.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>

namespace mebots::world::camera {
namespace {

constexpr int kChunk = 64;                  // pixels whose intermediate values stay in the first-level cache
constexpr int kVector = kSpareColumns + 1;  // pixels of the longest vectors
static_assert(kChunk % kVector == 0);

/// Returns condition ? a : b by operations on bits. In some loops below, GCC would turn the operator ?: into a branch
/// or a conditional store, and would not vectorise the loop.
std::int32_t select(bool condition, std::int32_t a, std::int32_t b) {
  const std::int32_t mask = -static_cast<std::int32_t>(condition);
  return (mask & a) | (~mask & b);
}
float select(bool condition, float a, float b) {
  return std::bit_cast<float>(select(condition, std::bit_cast<std::int32_t>(a), std::bit_cast<std::int32_t>(b)));
}

float magnitude(float x) {
  return x < 0.0F ? -x : x;
}
float larger(float a, float b) {
  return a > b ? a : b;
}
float smaller(float a, float b) {
  return a < b ? a : b;
}

struct Axis {
  std::int32_t index;  // in the ripmap's array
  float fraction;      // of the way to the next texel
};

/// Computes a texture look-up along one axis. `texels` is the coordinate in texels of level 0. `footprint` is the
/// pixel's extent in these texels. `size` is the tile's size in texels. Chooses the level whose texels are nearest to
/// the footprint in size, on a logarithmic scale.
Axis look_up(float texels, float footprint, float size) {
  constexpr float kSqrt2 = 1.41421356F;
  const float limited = smaller(larger(footprint * kSqrt2, 1.0F), size);
  const std::int32_t power = std::bit_cast<std::int32_t>(limited) & 0x7F800000;  // 2^level, as a float
  const float shrink = std::bit_cast<float>(0x7F000000 - power);                 // 2^-level
  const float at = texels * shrink - 0.5F;
  std::int32_t floor = static_cast<std::int32_t>(at);
  floor -= at < static_cast<float>(floor) ? 1 : 0;
  const std::int32_t level_size = static_cast<std::int32_t>(size * shrink);
  const std::int32_t start = 2 * (static_cast<std::int32_t>(size) - level_size);
  return {start + (floor & (level_size - 1)), at - static_cast<float>(floor)};
}

// The compiler generates each loop over pixels twice: for the vectors of every x86-64 processor, and for the longer
// vectors of AVX2. Both give the same bits, because no loop sums over pixels.
#if defined(__x86_64__) && defined(__GNUC__)
#define MEBOTS_LONG_VECTORS [[gnu::target("avx2")]]
const bool kHasLongVectors = __builtin_cpu_supports("avx2") != 0;
#else
#define MEBOTS_LONG_VECTORS
constexpr bool kHasLongVectors = false;
#endif

/// Rounds a number of pixels up to a multiple of the vector's length. Otherwise, short spans would spend most of their
/// time in a loop over the remaining single pixels.
int whole_vectors(int count) {
  return (count + kVector - 1) / kVector * kVector;
}

[[gnu::always_inline]] inline void test_depth_here(float w, float w_x, float x_0, int count, std::int32_t face,
                                                   float* __restrict inverse_depth, std::int32_t* __restrict faces) {
  const int whole = whole_vectors(count);
  for (int i = 0; i < whole; ++i) {
    const float here = w + w_x * (x_0 + static_cast<float>(i));
    const bool nearer = static_cast<int>(here > inverse_depth[i]) & static_cast<int>(i < count);
    inverse_depth[i] = select(nearer, here, inverse_depth[i]);
    faces[i] = select(nearer, face, faces[i]);
  }
}

MEBOTS_LONG_VECTORS void test_depth_long(float w, float w_x, float x_0, int count, std::int32_t face,
                                         float* __restrict inverse_depth, std::int32_t* __restrict faces) {
  test_depth_here(w, w_x, x_0, count, face, inverse_depth, faces);
}

[[gnu::always_inline]] inline void shade_here(const FaceView& view, double y, float x_0, int count,
                                              float* __restrict grey) {
  const Ripmap& ripmap = *view.ripmap;
  const FaceView f = view;
  const float w = static_cast<float>(f.w_0 + f.w_y * y);
  const float u = static_cast<float>(f.u_0 + f.u_y * y);
  const float v = static_cast<float>(f.v_0 + f.v_y * y);
  const float size = static_cast<float>(ripmap.size());
  const int row_shift = ripmap.row_shift();
  const std::uint32_t* const words = ripmap.words();

  alignas(64) std::int32_t place[kChunk];
  alignas(64) std::uint32_t word[kChunk];
  alignas(64) float fraction_u[kChunk];
  alignas(64) float fraction_v[kChunk];
  for (int begin = 0; begin < count; begin += kChunk) {
    const int n = std::min(kChunk, count - begin);
    const float x_begin = x_0 + static_cast<float>(begin);
    const int whole = whole_vectors(n);
    for (int i = 0; i < whole; ++i) {
      const float x = x_begin + static_cast<float>(std::min(i, n - 1));
      const float depth = 1.0F / (w + f.w_x * x);
      const float du = depth * (u + f.u_x * x);
      const float dv = depth * (v + f.v_x * x);
      const float footprint_u = depth * larger(magnitude(f.u_x - du * f.w_x), magnitude(f.u_y - du * f.w_y));
      const float footprint_v = depth * larger(magnitude(f.v_x - dv * f.w_x), magnitude(f.v_y - dv * f.w_y));
      const Axis column = look_up(f.u_eye + du, footprint_u, size);
      const Axis row = look_up(f.v_eye + dv, footprint_v, size);
      place[i] = (row.index << row_shift) + column.index;
      fraction_u[i] = column.fraction;
      fraction_v[i] = row.fraction;
    }
    for (int i = 0; i < whole; ++i) word[i] = words[place[i]];
    for (int i = 0; i < whole; ++i) {
      const std::uint32_t four = word[i];
      const float c00 = static_cast<float>(static_cast<std::int32_t>(four & 0xFFU));
      const float c10 = static_cast<float>(static_cast<std::int32_t>((four >> 8) & 0xFFU));
      const float c01 = static_cast<float>(static_cast<std::int32_t>((four >> 16) & 0xFFU));
      const float c11 = static_cast<float>(static_cast<std::int32_t>(four >> 24));
      const float upper = c00 + fraction_u[i] * (c10 - c00);
      const float lower = c01 + fraction_u[i] * (c11 - c01);
      grey[begin + i] = f.light * (upper + fraction_v[i] * (lower - upper));
    }
  }
}

MEBOTS_LONG_VECTORS void shade_long(const FaceView& view, double y, float x_0, int count, float* __restrict grey) {
  shade_here(view, y, x_0, count, grey);
}

}  // namespace

void test_depth(float w, float w_x, float x_0, int count, std::int32_t face, float* __restrict inverse_depth,
                std::int32_t* __restrict faces) {
  if (kHasLongVectors) {
    test_depth_long(w, w_x, x_0, count, face, inverse_depth, faces);
  } else {
    test_depth_here(w, w_x, x_0, count, face, inverse_depth, faces);
  }
}

void shade(const FaceView& view, double y, float x_0, int count, float* __restrict grey) {
  if (kHasLongVectors) {
    shade_long(view, y, x_0, count, grey);
  } else {
    shade_here(view, y, x_0, count, grey);
  }
}

void quantise(const float* __restrict grey, int count, std::uint8_t* __restrict pixels) {
  for (int i = 0; i < count; ++i) {
    const float rounded = grey[i] + 0.5F;
    const float positive = select(rounded > 0.0F, rounded, 0.0F);
    pixels[i] = static_cast<std::uint8_t>(static_cast<std::int32_t>(select(positive < 255.5F, positive, 255.0F)));
  }
}

}  // namespace mebots::world::camera
