// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/ripmap.hpp"

#include <cstdint>

/// The loops over pixels, in a form that compilers vectorise. They use only +, -, *, / and comparisons in single
/// precision, so every vector width gives the same bits.
namespace mebots::world::camera {

/// A face is not drawn where its inverse depth is below this value, which is at distances above 10 km.
inline constexpr float kFarthest_per_m = 1e-4F;

/// A face in one picture. x and y are the distances of a pixel's centre to the right of and below the picture's middle.
/// The inverse depth is w = w_0 + w_x x + w_y y. The texture coordinate in texels is u = u_eye + (u_0 + u_x x + u_y y)
/// / w. v has the same form.
struct FaceView {
  double w_0, u_0, v_0;
  float w_x, u_x, v_x;
  float w_y, u_y, v_y;
  float u_eye, v_eye;
  float light;
  const Ripmap* ripmap = nullptr;  // without one, `light` is the grey level, and no texture coordinate is set
};

/// The number of elements that the loops may write after the last pixel, to complete a vector.
inline constexpr int kSpareColumns = 7;

/// Assigns a face to the pixels of a row where the face is nearer than the assigned face. The centre of the first pixel
/// is at x = `x_0`. `w` is the face's inverse depth at x = 0 in this row. The arrays start at the first of `count`
/// pixels. They must have kSpareColumns more elements, which are not changed.
void test_depth(float w, float w_x, float x_0, int count, std::int32_t face, float* inverse_depth, std::int32_t* faces);

/// Computes the grey levels, without rounding and limits, of `count` pixels of the row at `y`. The centre of the first
/// pixel is at x = `x_0`. Overwrites the kSpareColumns elements after the last pixel. The face must have a ripmap.
void shade(const FaceView& view, double y, float x_0, int count, float* grey);

/// Rounds to the nearest integers and limits them to 0..255, as the sensor's converter does.
void quantise(const float* grey, int count, std::uint8_t* pixels);

}  // namespace mebots::world::camera
