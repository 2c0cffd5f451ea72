// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/bands.hpp"
#include "camera/lens.hpp"
#include "camera/pixel_noise.hpp"
#include "camera/renderer.hpp"

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace mebots::world::camera {

/// The columns [left, right) and rows [top, bottom) of a picture.
struct PixelBox {
  int left = 0;
  int top = 0;
  int right = 0;
  int bottom = 0;

  bool empty() const { return left >= right; }
  void add(int column, int row);
  bool operator==(const PixelBox&) const = default;
};

struct SeenObject {
  SceneObject::Kind kind;
  std::string name;
  PixelBox box;          ///< of all its pixels, as if nothing hid it
  PixelBox visible_box;  ///< of its visible pixels; empty if it is hidden
  int pixels = 0;        ///< in the picture, as if nothing hid it; > 0
  int visible_pixels = 0;
  double distance_m = 0.0;  ///< from the camera to the object's centre
};

/// Computes the objects and depths that the pixels of a picture show. Uses the geometry, the lens and the times of the
/// rows of this picture. A pixel of a distorted picture has the values of the nearest pixel of the undistorted picture.
class GroundTruth {
 public:
  /// Throws mebots::Error if `depth_noise_per_m` is negative or not finite.
  GroundTruth(const std::shared_ptr<const Scenery>& scenery, const Intrinsics& intrinsics, const LensSettings& lens,
              double line_time_s, double depth_noise_per_m);

  /// Writes the depth of each pixel along the optical axis in millimetres, as 16-bit little-endian numbers, row by row
  /// from the top left. If no surface is nearer than 65.5355 m, the depth is 0. The noise has the standard deviation
  /// depth_noise x depth^2. It depends only on seed, index, row and column. The first row shows the scene from
  /// pose_at(after_s).
  void depth(const PoseAt& pose_at, double after_s, std::uint64_t seed, std::uint64_t index,
             std::span<std::uint8_t> bytes);

  /// Returns the gates and drones in the picture, in the order of Geometry::objects.
  std::vector<SeenObject> objects(const PoseAt& pose_at, double after_s);

 private:
  void look(const PoseAt& pose_at, double after_s, std::uint32_t only);
  /// Returns false if no row of the picture can show the object.
  bool may_see(const PoseAt& pose_at, double after_s, std::uint32_t object);
  double distance_m(const SceneObject& object, const Pose& pose) const;

  std::shared_ptr<const Scenery> scenery_;
  Intrinsics intrinsics_;
  Lens lens_;
  double line_time_s_;
  double depth_noise_per_m_;
  Renderer renderer_;
  Renderer::Workspace workspace_;
  PixelNoise noise_;
  std::vector<Sight> sights_;  // of the undistorted picture
  std::vector<float> row_noise_;
};

}  // namespace mebots::world::camera
