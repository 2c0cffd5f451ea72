// SPDX-License-Identifier: Apache-2.0
#include "camera/ground_truth.hpp"

#include "math/checks.hpp"
#include "mebots/assert.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mebots::world::camera {
namespace {

constexpr double kMillimetres_per_m = 1000.0;

/// Returns a depth in millimetres. If the depth does not fit into 16 bits, returns 0.
std::uint16_t millimetres(double depth_m) {
  const double rounded = std::round(kMillimetres_per_m * depth_m);
  constexpr double kMost = std::numeric_limits<std::uint16_t>::max();
  return rounded >= 0.0 && rounded <= kMost ? static_cast<std::uint16_t>(rounded) : std::uint16_t{0};
}

}  // namespace

void PixelBox::add(int column, int row) {
  if (empty()) {
    *this = {column, row, column + 1, row + 1};
    return;
  }
  left = std::min(left, column);
  top = std::min(top, row);
  right = std::max(right, column + 1);
  bottom = std::max(bottom, row + 1);
}

GroundTruth::GroundTruth(const std::shared_ptr<const Scenery>& scenery, const Intrinsics& intrinsics,
                         const LensSettings& lens, double line_time_s, double depth_noise_per_m)
    : scenery_(scenery),
      intrinsics_(intrinsics),
      lens_(intrinsics, lens),
      line_time_s_(line_time_s),
      depth_noise_per_m_(depth_noise_per_m),
      renderer_(scenery, lens_.pinhole(), 0.0),
      workspace_(renderer_.make_workspace()),
      noise_(1.0) {
  require_at_least_zero(depth_noise_per_m, "camera.depth_noise");
  const Intrinsics& pinhole = lens_.pinhole();
  sights_.resize(static_cast<std::size_t>(pinhole.width) * static_cast<std::size_t>(pinhole.height));
  row_noise_.resize(static_cast<std::size_t>(intrinsics.width));
}

void GroundTruth::look(const PoseAt& pose_at, double after_s, std::uint32_t only) {
  for_each_band(lens_.pinhole(), intrinsics_, line_time_s_, [&](int first, int end, double later_s) {
    renderer_.look(pose_at(after_s + later_s), first, end, only, sights_, workspace_);
  });
}

bool GroundTruth::may_see(const PoseAt& pose_at, double after_s, std::uint32_t object) {
  bool found = false;
  for_each_band(lens_.pinhole(), intrinsics_, line_time_s_, [&](int first, int end, double later_s) {
    found = found || renderer_.may_see(pose_at(after_s + later_s), first, end, object, workspace_);
  });
  return found;
}

void GroundTruth::depth(const PoseAt& pose_at, double after_s, std::uint64_t seed, std::uint64_t index,
                        std::span<std::uint8_t> bytes) {
  const auto width = static_cast<std::size_t>(intrinsics_.width);
  const auto height = static_cast<std::size_t>(intrinsics_.height);
  MEBOTS_ASSERT(bytes.size() == 2 * width * height);
  look(pose_at, after_s, kEveryObject);
  for (std::size_t row = 0; row < height; ++row) {
    std::fill(row_noise_.begin(), row_noise_.end(), 0.0F);
    if (depth_noise_per_m_ > 0.0) noise_.add(row_noise_, seed, index, static_cast<int>(row));
    for (std::size_t column = 0; column < width; ++column) {
      const Lens::Source source = lens_.source(row * width + column);
      const double depth_m = sights_[source.pixel].depth_m(source.right, source.down);
      const double noise_m = depth_noise_per_m_ * depth_m * depth_m * row_noise_[column];
      const std::uint16_t value = millimetres(depth_m + noise_m);
      bytes[2 * (row * width + column)] = static_cast<std::uint8_t>(value & 0xFFU);
      bytes[2 * (row * width + column) + 1] = static_cast<std::uint8_t>(value >> 8U);
    }
  }
}

std::vector<SeenObject> GroundTruth::objects(const PoseAt& pose_at, double after_s) {
  const auto& objects = scenery_->geometry.objects;
  std::vector<SeenObject> seen(objects.size());
  const auto for_each_pixel = [&](auto&& act) {
    for (int row = 0; row < intrinsics_.height; ++row) {
      for (int column = 0; column < intrinsics_.width; ++column) {
        const auto pixel = static_cast<std::size_t>(row) * static_cast<std::size_t>(intrinsics_.width) +
                           static_cast<std::size_t>(column);
        const std::uint32_t object = sights_[lens_.source(pixel).pixel].object;
        if (object != kNoObject) act(seen[object], column, row);
      }
    }
  };
  look(pose_at, after_s, kEveryObject);
  for_each_pixel([](SeenObject& object, int column, int row) {
    object.visible_box.add(column, row);
    ++object.visible_pixels;
  });
  const Pose middle = pose_at(after_s + 0.5 * line_time_s_ * (intrinsics_.height - 1));
  for (std::size_t i = 0; i < objects.size(); ++i) {
    seen[i].kind = objects[i].kind;
    seen[i].name = objects[i].name;
    seen[i].distance_m = distance_m(objects[i], middle);
  }
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const auto only = static_cast<std::uint32_t>(i);
    if (seen[i].visible_pixels == 0 && !may_see(pose_at, after_s, only)) continue;
    look(pose_at, after_s, only);
    for_each_pixel([](SeenObject& object, int column, int row) {
      object.box.add(column, row);
      ++object.pixels;
    });
  }
  std::erase_if(seen, [](const SeenObject& object) { return object.pixels == 0; });
  return seen;
}

double GroundTruth::distance_m(const SceneObject& object, const Pose& pose) const {
  if (object.body == Mover::kNoBody) return (object.centre_m - pose.p_WC_m).norm();
  if (object.body >= pose.bodies.size()) return 0.0;
  const BodyPose& body = pose.bodies[object.body];
  return (body.p_WB_m + body.R_WB * object.centre_m - pose.p_WC_m).norm();
}

}  // namespace mebots::world::camera
