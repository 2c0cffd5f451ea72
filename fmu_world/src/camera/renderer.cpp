// SPDX-License-Identifier: Apache-2.0
#include "camera/renderer.hpp"

#include "math/rotation.hpp"
#include "mebots/assert.hpp"
#include "mebots/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace mebots::world::camera {
namespace {

using Eigen::Vector3d;

/// If the camera's distance from a face's plane is less than this, the face is edge-on and is not drawn.
constexpr double kEdgeOn_m = 1e-9;

void check(const Intrinsics& intrinsics) {
  const auto check_size = [](const char* what, int pixels) {
    if (pixels < 8 || pixels > 2048)
      throw Error(fmt::format("camera: {} of {} pixels is outside 8..2048", what, pixels));
  };
  check_size("width", intrinsics.width);
  check_size("height", intrinsics.height);
  const double fov = intrinsics.horizontal_field_of_view_rad;
  if (!(fov >= 0.1 && fov <= 3.0)) {
    throw Error(fmt::format("camera: horizontal field of view of {} rad is outside 0.1..3.0 rad", fov));
  }
}

Geometry checked(Geometry geometry) {
  for (std::size_t i = 0; i < geometry.faces.size(); ++i) {
    const Face& face = geometry.faces[i];
    const std::size_t corners = face.corners_W_m.size();
    if (corners < 3 || corners > kMaxCorners) {
      throw Error(fmt::format("camera: face {} has {} corners; it must have 3 to {}; divide the face", i, corners,
                              kMaxCorners));
    }
    if (face.mover != Face::kStatic && face.mover >= geometry.movers.size()) {
      throw Error(fmt::format("camera: face {} refers to mover {} of {}", i, face.mover, geometry.movers.size()));
    }
    if (face.tile >= geometry.tiles.size()) {
      throw Error(fmt::format("camera: face {} refers to texture {} of {}", i, face.tile, geometry.tiles.size()));
    }
  }
  return geometry;
}

/// The number of rows in a strip. All rows of a strip are rendered together. With more rows, a face occurs in fewer
/// strips. But the depths of a strip must fit into the first-level cache.
constexpr int kStripRows = Outline::kStripRows;

constexpr std::int32_t kNothing = -1;

double below_middle(int row, const Intrinsics& intrinsics) {
  return row + 0.5 - 0.5 * intrinsics.height;
}

/// Returns the distance of the first column's centre to the right of the picture's middle, in pixels. It is negative.
float left_centre(const Intrinsics& intrinsics) {
  return 0.5F - 0.5F * static_cast<float>(intrinsics.width);
}

/// A linear function of a pixel's position, which is x to the right of and y below the picture's middle: value(x, y) =
/// at_0 + x along_x + y along_y.
struct PixelPlane {
  double at_0, along_x, along_y;
};

/// Returns direction . ray for the ray (1, -x/f, -y/f) in the camera frame.
PixelPlane along_ray(const Vector3d& direction_W, const Eigen::Matrix3d& R_WC, double focal_length_px) {
  const Vector3d direction_C = R_WC.transpose() * direction_W;
  return {direction_C.x(), -direction_C.y() / focal_length_px, -direction_C.z() / focal_length_px};
}

/// Returns the camera's position along an axis in texels, modulo the tile's size.
float eye_texel(double along_axis_m, double edge_m, int size) {
  const double tiles = along_axis_m / edge_m;
  return static_cast<float>((tiles - std::floor(tiles)) * size);
}

/// True for the drone that carries the camera, and for each drone or robot whose position the pose does not contain.
bool is_hidden(const Mover& mover, const Pose& pose) {
  return mover.body != Mover::kNoBody && (mover.body >= pose.bodies.size() || mover.body == pose.own_body);
}

/// Returns the camera's pose in the coordinates of a mover's faces. For a drone or robot, this is the body's frame. For
/// an object on a path, these are world coordinates in which the object has not moved from its position in the scene.
/// If the mover is hidden, returns `pose` unchanged.
Pose seen_from(const Mover& mover, const Pose& pose) {
  if (is_hidden(mover, pose)) return pose;
  if (mover.body != Mover::kNoBody) {
    const BodyPose& body = pose.bodies[mover.body];
    const Eigen::Matrix3d R_BW = body.R_WB.transpose();
    return {R_BW * (pose.p_WC_m - body.p_WB_m), R_BW * pose.R_WC, pose.time_ns};
  }
  const scene::Displacement moved = mover.path.at(pose.time_ns);
  const Eigen::Matrix3d back = yaw_rotation(-moved.turn_rad).toRotationMatrix();
  return {mover.origin_W_m + back * (pose.p_WC_m - moved.offset_W_m - mover.origin_W_m), back * pose.R_WC,
          pose.time_ns};
}

FaceView view_of(const FaceCover& face, double light, const Pose& pose, double height_over_plane_m,
                 double focal_length_px) {
  MEBOTS_ASSERT(height_over_plane_m >= kEdgeOn_m);
  // The ray of a pixel meets the face's plane at the depth d for which normal . (p_WC + d ray) = offset.
  const PixelPlane n = along_ray(face.normal_W, pose.R_WC, focal_length_px);
  const double per_height = -1.0 / height_over_plane_m;
  FaceView view;
  view.w_0 = n.at_0 * per_height;
  view.w_x = static_cast<float>(n.along_x * per_height);
  view.w_y = static_cast<float>(n.along_y * per_height);
  view.light = static_cast<float>(light);
  return view;
}

void add_texture(const Face& face, const Tile& tile, const Pose& pose, double focal_length_px, FaceView& view) {
  const double texels_per_m_u = tile.ripmap.size() / tile.edge_u_m;
  const double texels_per_m_v = tile.ripmap.size() / tile.edge_v_m;
  MEBOTS_ASSERT(tile.edge_u_m > 0 && tile.edge_v_m > 0);
  const PixelPlane u = along_ray(face.u_axis_W, pose.R_WC, focal_length_px);
  const PixelPlane v = along_ray(face.v_axis_W, pose.R_WC, focal_length_px);
  const Vector3d from_origin = pose.p_WC_m - face.texture_origin_W_m;
  view.u_0 = u.at_0 * texels_per_m_u;
  view.u_x = static_cast<float>(u.along_x * texels_per_m_u);
  view.u_y = static_cast<float>(u.along_y * texels_per_m_u);
  view.v_0 = v.at_0 * texels_per_m_v;
  view.v_x = static_cast<float>(v.along_x * texels_per_m_v);
  view.v_y = static_cast<float>(v.along_y * texels_per_m_v);
  view.u_eye = eye_texel(face.u_axis_W.dot(from_origin) + face.u_origin_m, tile.edge_u_m, tile.ripmap.size());
  view.v_eye = eye_texel(face.v_axis_W.dot(from_origin) + face.v_origin_m, tile.edge_v_m, tile.ripmap.size());
  view.ripmap = &tile.ripmap;
}

}  // namespace

Scenery::Scenery(Geometry all)
    : geometry(checked(std::move(all))), covers(geometry.faces), groups(groups_of(geometry.faces)) {}

Renderer::Renderer(const scene::Scene& scene, Intrinsics intrinsics, double noise_std)
    : Renderer(make_geometry(scene), intrinsics, noise_std) {}

Renderer::Renderer(Geometry geometry, Intrinsics intrinsics, double noise_std)
    : Renderer(std::make_shared<const Scenery>(std::move(geometry)), intrinsics, noise_std) {}

Renderer::Renderer(std::shared_ptr<const Scenery> scenery, Intrinsics intrinsics, double noise_std)
    : scenery_(std::move(scenery)), intrinsics_(intrinsics), noise_(noise_std) {
  check(intrinsics_);
  workspace_ = make_workspace();
}

Renderer::Workspace Renderer::make_workspace() const {
  Workspace workspace;
  workspace.faces_.reserve(scenery_->geometry.faces.size());
  // A clip plane adds at most one corner. The last kMaxOutlineCorners elements serve an outline under construction.
  workspace.edges_.resize(scenery_->covers.corners_W_m.size() + kClipPlanes * scenery_->geometry.faces.size() +
                          kMaxOutlineCorners);
  workspace.strips_.resize(static_cast<std::size_t>((intrinsics_.height + kStripRows - 1) / kStripRows) + 1);
  workspace.by_strip_.reserve(scenery_->geometry.faces.size());
  workspace.active_.reserve(scenery_->geometry.faces.size());
  workspace.next_.reserve(scenery_->geometry.faces.size());
  workspace.eyes_.resize(scenery_->geometry.movers.size());
  const auto columns = static_cast<std::size_t>(intrinsics_.width) + kSpareColumns;
  workspace.inverse_depth_.resize(columns * kStripRows);
  workspace.nearest_.resize(columns * kStripRows);
  workspace.grey_.resize(columns);
  return workspace;
}

void Renderer::find_visible(const Pose& pose, int first_row, int end_row, std::uint32_t only,
                            Workspace& workspace) const {
  const double focal_length_px = intrinsics_.focal_length_px();
  const Outline::Picture picture{focal_length_px, intrinsics_.width, intrinsics_.height};
  const PictureSides sides(intrinsics_, first_row, end_row);
  workspace.faces_.clear();
  std::size_t edges = 0;
  for (std::size_t i = 0; i < scenery_->geometry.movers.size(); ++i)
    workspace.eyes_[i] = seen_from(scenery_->geometry.movers[i], pose);
  MEBOTS_ASSERT(workspace.nearest_.size() == (static_cast<std::size_t>(intrinsics_.width) + kSpareColumns) * kStripRows,
                "make_workspace() made it");
  for (const FaceGroup& group : scenery_->groups) {
    const bool stands = group.mover == Face::kStatic;
    if (!stands && is_hidden(scenery_->geometry.movers[group.mover], pose)) continue;
    const Pose& eye = stands ? pose : workspace.eyes_[group.mover];
    const Eigen::Matrix3d R_CE = eye.R_WC.transpose();
    if (sides.leave_out(R_CE * (group.middle_W_m - eye.p_WC_m), group.radius_m)) continue;
    for (std::size_t k = group.first; k < group.end; ++k) {
      const FaceCover& cover = scenery_->covers.faces[k];
      if (only != kEveryObject && cover.object != only) continue;
      const double height_over_plane_m = cover.normal_W.dot(eye.p_WC_m) - cover.offset_m;
      if (height_over_plane_m < kEdgeOn_m) continue;  // back or edge-on
      const auto corners_W = scenery_->covers.corners_of(cover);
      std::array<Vector3d, kMaxCorners> corners_C;
      MEBOTS_ASSERT(corners_W.size() <= corners_C.size(), "checked() has seen it");
      bool before = false;  // true if the camera is in front of it
      for (std::size_t i = 0; i < corners_W.size(); ++i) {
        corners_C[i] = R_CE * (corners_W[i] - eye.p_WC_m);
        before = before || corners_C[i].x() > kNearPlane_m;
      }
      const std::span<const Vector3d> corners(corners_C.data(), corners_W.size());
      if (!before || sides.leave_out(corners)) continue;
      const Outline outline(picture, corners, Outline::Edges(workspace.edges_.data() + edges, kMaxOutlineCorners));
      if (std::max(outline.first_row(), first_row) >= std::min(outline.end_row(), end_row)) continue;
      edges += static_cast<std::size_t>(outline.edge_count());
      const double light =
          stands ? cover.light : lambert(scenery_->geometry.lighting, pose.R_WC * (R_CE * cover.normal_W));
      FaceView view = view_of(cover, light, eye, height_over_plane_m, focal_length_px);
      MEBOTS_ASSERT(cover.tile < scenery_->geometry.tiles.size(), "checked() has seen it");
      const Tile& tile = *scenery_->geometry.tiles[cover.tile];
      if (tile.ripmap.size() == 1) {
        view.light *= static_cast<float>(tile.ripmap.texel(0, 0, 0, 0));
      } else {
        add_texture(scenery_->geometry.faces[k], tile, eye, focal_length_px, view);
      }
      workspace.faces_.push_back({outline, view, cover.object});
    }
  }
  sort_by_strip(first_row, workspace);
}

/// Uses a counting sort, which is stable: the faces of one strip keep their order.
void Renderer::sort_by_strip(int first_row, Workspace& workspace) {
  auto& strips = workspace.strips_;
  const auto strip_of = [=](const Workspace::VisibleFace& face) {
    return static_cast<std::size_t>(std::max(face.outline.first_row() - first_row, 0) / kStripRows);
  };
  std::fill(strips.begin(), strips.end(), 0);
  for (const auto& face : workspace.faces_) ++strips[strip_of(face)];
  std::size_t sum = 0;
  for (auto& strip : strips) sum += std::exchange(strip, sum);
  workspace.by_strip_.resize(workspace.faces_.size());
  for (std::size_t i = 0; i < workspace.faces_.size(); ++i)
    workspace.by_strip_[strips[strip_of(workspace.faces_[i])]++] = static_cast<std::int32_t>(i);
  // Each entry is now the end of its strip's faces, which is the start of the next strip's faces. Shifts the entries,
  // so that each is the start of its strip's faces.
  std::rotate(strips.begin(), strips.end() - 1, strips.end());
  strips[0] = 0;
  workspace.active_.clear();
}

/// Updates the list of faces that cover the strip: removes faces that end before it, and adds faces that start in it.
/// The list keeps the order of the faces.
void Renderer::enter_strip(std::size_t strip, int first, Workspace& workspace) {
  const auto& by_strip = workspace.by_strip_;
  std::size_t coming = workspace.strips_[strip];
  const std::size_t end = workspace.strips_[strip + 1];
  workspace.next_.clear();
  for (const std::int32_t face : workspace.active_) {
    while (coming < end && by_strip[coming] < face) workspace.next_.push_back(by_strip[coming++]);
    if (first < workspace.faces_[static_cast<std::size_t>(face)].outline.end_row()) workspace.next_.push_back(face);
  }
  while (coming < end) workspace.next_.push_back(by_strip[coming++]);
  workspace.active_.swap(workspace.next_);
}

void Renderer::see_strip(std::size_t strip, int first, int end, Workspace& workspace) const {
  enter_strip(strip, first, workspace);
  const int width = intrinsics_.width;
  const std::ptrdiff_t stride = width + kSpareColumns;
  float* const inverse_depth = workspace.inverse_depth_.data();
  std::int32_t* const nearest = workspace.nearest_.data();
  std::fill_n(inverse_depth, stride * (end - first), kFarthest_per_m);
  std::fill_n(nearest, stride * (end - first), kNothing);
  const float x_0 = left_centre(intrinsics_);
  for (const std::int32_t i : workspace.active_) {
    const auto& [outline, view, object] = workspace.faces_[static_cast<std::size_t>(i)];
    outline.spans(first, end, [&](int row, int from, int to) {
      MEBOTS_ASSERT(row >= first && row < end && from >= 0 && to <= width);
      const auto w = static_cast<float>(view.w_0 + view.w_y * below_middle(row, intrinsics_));
      const std::ptrdiff_t at = stride * (row - first) + from;
      test_depth(w, view.w_x, x_0 + static_cast<float>(from), to - from, i, inverse_depth + at, nearest + at);
    });
  }
}

void Renderer::shade_row(int row, const std::int32_t* nearest, const Workspace& workspace, float* grey) const {
  const int width = intrinsics_.width;
  const float x_0 = left_centre(intrinsics_);
  for (int begin = 0; begin < width;) {
    int end = begin + 1;
    while (end < width && nearest[end] == nearest[begin]) ++end;
    const FaceView* const view =
        nearest[begin] == kNothing ? nullptr : &workspace.faces_[static_cast<std::size_t>(nearest[begin])].view;
    if (view != nullptr && view->ripmap != nullptr) {
      shade(*view, below_middle(row, intrinsics_), x_0 + static_cast<float>(begin), end - begin, grey + begin);
    } else {
      const float alike = view != nullptr ? view->light : static_cast<float>(scenery_->geometry.background);
      for (int i = begin; i < end; ++i) grey[i] = alike;
    }
    begin = end;
  }
}

template <typename Act>
void Renderer::for_each_row(const Pose& pose, int first, int end, std::uint32_t only, Workspace& workspace,
                            Act&& act) const {
  find_visible(pose, first, end, only, workspace);
  const std::ptrdiff_t stride = intrinsics_.width + kSpareColumns;
  std::size_t strip = 0;
  for (int top = first; top < end; top += kStripRows) {
    const int bottom = std::min(top + kStripRows, end);
    see_strip(strip++, top, bottom, workspace);
    for (int row = top; row < bottom; ++row) act(row, workspace.nearest_.data() + stride * (row - top));
  }
}

template <typename Shaded>
void Renderer::shade_rows(const Pose& pose, int first, int end, Workspace& workspace, Shaded&& shaded) const {
  for_each_row(pose, first, end, kEveryObject, workspace, [&](int row, const std::int32_t* nearest) {
    shade_row(row, nearest, workspace, workspace.grey_.data());
    shaded(row);
  });
}

void Renderer::look(const Pose& pose, int first_row, int end_row, std::uint32_t only, std::span<Sight> sights,
                    Workspace& workspace) const {
  const int width = intrinsics_.width;
  MEBOTS_ASSERT(sights.size() >= static_cast<std::size_t>(end_row) * static_cast<std::size_t>(width));
  for_each_row(pose, first_row, end_row, only, workspace, [&](int row, const std::int32_t* nearest) {
    for (int column = 0; column < width; ++column) {
      Sight& sight = sights[static_cast<std::size_t>(row) * width + column];
      sight = {};
      if (nearest[column] == kNothing) continue;
      const auto& [outline, view, object] = workspace.faces_[static_cast<std::size_t>(nearest[column])];
      const double x = column + 0.5 - 0.5 * width;
      const double inverse = view.w_0 + view.w_x * x + view.w_y * below_middle(row, intrinsics_);
      sight = {inverse, view.w_x, view.w_y, object};
    }
  });
}

bool Renderer::may_see(const Pose& pose, int first_row, int end_row, std::uint32_t object, Workspace& workspace) const {
  find_visible(pose, first_row, end_row, object, workspace);
  return !workspace.faces_.empty();
}

void Renderer::render_light(const Pose& pose, int first_row, int end_row, std::span<float> grey,
                            Workspace& workspace) const {
  const int width = intrinsics_.width;
  MEBOTS_ASSERT(first_row >= 0 && end_row <= intrinsics_.height &&
                grey.size() >= static_cast<std::size_t>(end_row) * width);
  shade_rows(pose, first_row, end_row, workspace, [&](int row) {
    std::copy_n(workspace.grey_.data(), width, grey.data() + static_cast<std::size_t>(row) * width);
  });
}

void Renderer::render(const Pose& pose, std::uint64_t seed, std::uint64_t frame_index, std::span<std::uint8_t> pixels,
                      Workspace& workspace) const {
  const int width = intrinsics_.width;
  const int height = intrinsics_.height;
  if (pixels.size() != static_cast<std::size_t>(width) * height) {
    throw Error(fmt::format("camera: a picture of {} x {} needs {} bytes, not {}", width, height,
                            static_cast<std::size_t>(width) * height, pixels.size()));
  }
  float* const grey = workspace.grey_.data();
  shade_rows(pose, 0, height, workspace, [&](int row) {
    noise_.add({grey, static_cast<std::size_t>(width)}, seed, frame_index, row);
    quantise(grey, width, pixels.data() + static_cast<std::size_t>(row) * width);
  });
}

}  // namespace mebots::world::camera
