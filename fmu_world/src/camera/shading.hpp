// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/ripmap.hpp"

#include <cstdint>

/// The loops over pixels, written so that the compiler turns them into vector code. Only +, -, *, / and
/// comparisons of single precision, so every vector width gives the same bits.
namespace mebots::world::camera {

/// Faces whose inverse depth at a pixel is less than this are not drawn there (10 km).
inline constexpr float kFarthest_per_m = 1e-4F;

/// A face in one picture. With x and y a pixel centre's distance to the right of and below the picture's middle, the
/// inverse depth is w = w_0 + w_x x + w_y y. The texture coordinate in texels
/// u = u_eye + (u_0 + u_x x + u_y y) / w; v alike.
struct FaceView {
  double w_0, u_0, v_0;
  float w_x, u_x, v_x;
  float w_y, u_y, v_y;
  float u_eye, v_eye;
  float light;
  const Ripmap* ripmap = nullptr;  // without one, `light` is the grey level, and no texture coordinate is set
};

/// How far the loops may go behind their last pixel, so that they take whole vectors.
inline constexpr int kSpareColumns = 7;

/// Takes over the pixels of a row where a face is nearer than what is there. All arrays begin at the first of
/// `count` pixels, whose centre is at x = `x_0`, and go on for kSpareColumns after the last one, which stay as they
/// are. `w` is the face's inverse depth at x = 0 in this row.
void test_depth(float w, float w_x, float x_0, int count, std::int32_t face, float* inverse_depth, std::int32_t* faces);

/// Grey levels, unrounded and unlimited, of `count` pixels of the row at `y`, from the pixel at x = `x_0` on. What
/// stood in the kSpareColumns after them is lost. The face has a ripmap.
void shade(const FaceView& view, double y, float x_0, int count, float* grey);

/// Rounds to the nearest of 0..255 and saturates, as the sensor's converter does.
void quantise(const float* grey, int count, std::uint8_t* pixels);

}  // namespace mebots::world::camera
