// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/ripmap.hpp"

#include <cstdint>

/// The loops over pixels, written for vectorisation by the compiler. They only use +, -, *, / and comparisons in single
/// precision, so every vector width gives the same bits.
namespace mebots::world::camera {

/// A face is not drawn where its inverse depth is below this value (at more than 10 km).
inline constexpr float kFarthest_per_m = 1e-4F;

/// A face in one picture. x and y are the distances of a pixel's centre to the right of and below the picture's middle.
/// The inverse depth is w = w_0 + w_x x + w_y y. The texture coordinate in texels is u = u_eye + (u_0 + u_x x + u_y y)
/// / w; v has the same form.
struct FaceView {
  double w_0, u_0, v_0;
  float w_x, u_x, v_x;
  float w_y, u_y, v_y;
  float u_eye, v_eye;
  float light;
  const Ripmap* ripmap = nullptr;  // without one, `light` is the grey level, and no texture coordinate is set
};

/// Number of pixels after the last pixel of a call that the loops may write in order to complete a vector.
inline constexpr int kSpareColumns = 7;

/// Replaces the pixels of a row where the face is nearer than the present one. All arrays begin at the first of `count`
/// pixels, whose centre is at x = `x_0`, and have kSpareColumns more elements, which are not changed. `w` is the face's
/// inverse depth at x = 0 in this row.
void test_depth(float w, float w_x, float x_0, int count, std::int32_t face, float* inverse_depth, std::int32_t* faces);

/// Computes grey levels, unrounded and unlimited, of `count` pixels of the row at `y`, from the pixel at x = `x_0` on.
/// Overwrites the kSpareColumns after them. The face must have a ripmap.
void shade(const FaceView& view, double y, float x_0, int count, float* grey);

/// Rounds to the nearest integer and limits to 0..255, as the sensor's converter does.
void quantise(const float* grey, int count, std::uint8_t* pixels);

}  // namespace mebots::world::camera
