// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/culling.hpp"
#include "camera/geometry.hpp"
#include "camera/lens.hpp"
#include "camera/outline.hpp"
#include "camera/pixel_noise.hpp"
#include "camera/shading.hpp"
#include "scene/scene.hpp"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace mebots::world::camera {

/// A geometry, and the tables that the renderer derives from it. Constant after construction.
struct Scenery {
  /// Throws mebots::Error if a face has fewer than 3 or more than 8 corners.
  explicit Scenery(Geometry all);
  Geometry geometry;
  FaceCovers covers;
  std::vector<FaceGroup> groups;
};

/// The plane that a pixel shows. Its inverse depth along the optical axis is a linear function of column and row.
struct Sight {
  double inverse_depth_per_m = 0.0;      ///< at the pixel's centre; 0 where there is no face
  float along_x = 0.0F, along_y = 0.0F;  ///< change to the next pixel to the right, and down
  std::uint32_t object = kNoObject;      ///< index in Geometry::objects

  /// Returns the depth of the plane at a point that is `right` and `down` pixels from the pixel's centre; 0 if the
  /// pixel shows no face.
  double depth_m(double right, double down) const {
    const double inverse = inverse_depth_per_m + along_x * right + along_y * down;
    return inverse > kFarthest_per_m ? 1.0 / inverse : 0.0;
  }
};

/// Selects all faces, including faces that belong to no object.
inline constexpr std::uint32_t kEveryObject = kNoObject;

/// The drone's camera: a pinhole camera with an 8-bit grey sensor.
///
/// First excludes faces and groups of faces that cannot be in the picture. Then processes strips of 16 rows: tests the
/// pixels of every face against the inverse depths of the strip, and textures each visible pixel once, with correct
/// perspective. Finally adds noise, rounds each row, and limits it to 0..255. The same arguments give the same bytes,
/// for any renderer, thread or vector unit. After construction, the renderer does not use the heap.
class Renderer {
 public:
  /// Working memory of a call. Threads that render at the same time need separate workspaces.
  class Workspace {
    friend class Renderer;
    struct VisibleFace {
      Outline outline;
      FaceView view;
      std::uint32_t object;
    };
    std::vector<VisibleFace> faces_;
    std::vector<Outline::Edge> edges_;    // of their outlines
    std::vector<std::size_t> strips_;     // start of each strip's faces in by_strip_
    std::vector<std::int32_t> by_strip_;  // faces by their first strip, then in their order
    std::vector<std::int32_t> active_;    // faces of the present strip, in their order
    std::vector<std::int32_t> next_;
    std::vector<Pose> eyes_;             // pose of the camera relative to each mover
    std::vector<float> inverse_depth_;   // of the strip's pixels
    std::vector<std::int32_t> nearest_;  // nearest face of each pixel
    std::vector<float> grey_;
  };

  /// `noise_std` is in grey levels. Throws mebots::Error if a size is outside 8..2048 pixels, the field of view is
  /// outside 0.1..3.0 rad, or the noise is negative.
  Renderer(const scene::Scene& scene, Intrinsics intrinsics, double noise_std);
  /// Throws the same errors. Also throws mebots::Error if a face has fewer than 3 or more than 8 corners.
  Renderer(Geometry geometry, Intrinsics intrinsics, double noise_std);
  /// Several cameras may share a scenery.
  Renderer(std::shared_ptr<const Scenery> scenery, Intrinsics intrinsics, double noise_std);

  const Intrinsics& intrinsics() const { return intrinsics_; }

  /// Writes width x height grey levels, row by row from the top left. The noise depends only on `seed`, `frame_index`
  /// and the pixel's row and column. Throws mebots::Error if `pixels` has another size. Not thread-safe, because all
  /// calls use the renderer's own workspace.
  void render(const Pose& pose, std::uint64_t seed, std::uint64_t frame_index, std::span<std::uint8_t> pixels) {
    render(pose, seed, frame_index, pixels, workspace_);
  }

  /// Works as the overload without `workspace`. Threads may call it at the same time if each has its own workspace.
  void render(const Pose& pose, std::uint64_t seed, std::uint64_t frame_index, std::span<std::uint8_t> pixels,
              Workspace& workspace) const;
  Workspace make_workspace() const;

  /// Computes the light without noise and rounding, in grey levels, for the rows [first_row, end_row). `grey` starts at
  /// row 0 and has `width` numbers per row.
  void render_light(const Pose& pose, int first_row, int end_row, std::span<float> grey, Workspace& workspace) const;

  /// Stores in `sights` which plane each pixel of the rows [first_row, end_row) shows. `sights` starts at row 0. If
  /// `only` is the index of an object, ignores all other objects.
  void look(const Pose& pose, int first_row, int end_row, std::uint32_t only, std::span<Sight> sights,
            Workspace& workspace) const;

  /// Returns false if look() would find no face of an object in these rows.
  bool may_see(const Pose& pose, int first_row, int end_row, std::uint32_t object, Workspace& workspace) const;

 private:
  /// Finds the faces that may be visible in the rows [first, end). If `only` is the index of an object, ignores all
  /// other objects.
  void find_visible(const Pose& pose, int first_row, int end_row, std::uint32_t only, Workspace& workspace) const;
  static void sort_by_strip(int first_row, Workspace& workspace);
  /// Finds the nearest faces in a strip with the rows [first, end). Call this function after find_visible(), for the
  /// strips in rising order.
  void see_strip(std::size_t strip, int first, int end, Workspace& workspace) const;
  static void enter_strip(std::size_t strip, int first, Workspace& workspace);
  /// Finds the visible faces. Calls act(row, nearest) for each row with the nearest face of each pixel.
  template <typename Act>
  void for_each_row(const Pose& pose, int first, int end, std::uint32_t only, Workspace& workspace, Act&& act) const;
  /// Computes the light of each of the rows [first, end) in the workspace's `grey_`, then calls shaded(row).
  template <typename Shaded>
  void shade_rows(const Pose& pose, int first, int end, Workspace& workspace, Shaded&& shaded) const;
  void shade_row(int row, const std::int32_t* nearest, const Workspace& workspace, float* grey) const;

  std::shared_ptr<const Scenery> scenery_;
  Intrinsics intrinsics_;
  PixelNoise noise_;
  Workspace workspace_;
};

}  // namespace mebots::world::camera
