// SPDX-License-Identifier: Apache-2.0
#include "sensors/camera_device.hpp"

#include "mebots/assert.hpp"
#include "noise/counter_noise.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <functional>

namespace mebots::world {
namespace {

using Json = nlohmann::ordered_json;

/// Returns the state after `after_s` seconds if the body continues its motion.
RigidState continued(const RigidState& body, double after_s) {
  RigidState then = body;
  if (after_s > 0.0) {
    then.p_WB_m += after_s * body.v_WB_m_per_s;
    const double turn_rad = after_s * body.w_WB_W_rad_per_s.norm();
    if (turn_rad > 0.0) {
      then.q_WB = Eigen::Quaterniond(Eigen::AngleAxisd(turn_rad, body.w_WB_W_rad_per_s.normalized())) * body.q_WB;
    }
  }
  return then;
}

Json json_of(const camera::PixelBox& box) {
  return {box.left, box.top, box.right, box.bottom};
}

Json json_of(const camera::SeenObject& object) {
  Json json = {{"class", object.kind == camera::SceneObject::Kind::gate ? "gate" : "drone"},
               {"name", object.name},
               {"box", json_of(object.box)}};
  if (!object.visible_box.empty()) json["visible_box"] = json_of(object.visible_box);
  json["visible"] = static_cast<double>(object.visible_pixels) / object.pixels;
  json["distance"] = object.distance_m;
  return json;
}

}  // namespace

CameraDevice::CameraDevice(const std::shared_ptr<const camera::Scenery>& scenery, const Settings& settings)
    : settings_(settings) {
  if (settings.lens.is_neutral() && settings.sensor.is_neutral()) {
    renderer_.emplace(scenery, settings.intrinsics, settings.sensor.noise_std);
  } else {
    sensor_.emplace(scenery, settings.intrinsics, settings.lens, settings.sensor);
  }
  if (settings.labels || settings.depth) {
    truth_ = std::make_unique<camera::GroundTruth>(scenery, settings.intrinsics, settings.lens,
                                                   settings.sensor.line_time_s, settings.depth_noise_per_m);
  }
  const auto pixels =
      static_cast<std::size_t>(settings.intrinsics.width) * static_cast<std::size_t>(settings.intrinsics.height);
  for (auto& buffer : buffers_) buffer.resize(pixels);
  for (auto& depth : depths_) depth.resize(settings.depth ? 2 * pixels : 0);
}

void CameraDevice::see_trigger(std::int32_t count, const RigidState& body, std::int64_t time_ns, const Others& others) {
  if (count == last_count_) return;
  last_count_ = count;
  if (count == 0) return;
  front_ ^= 1U;
  MEBOTS_ASSERT(front_ < buffers_.size());
  pictured_.body = body;
  pictured_.others.assign(others.states.begin(), others.states.end());
  pictured_.own = others.own;
  pictured_.time_ns = time_ns;
  // The noise depends on the number of the picture, not on how many pictures were taken.
  const std::uint64_t seed = noise::bits(settings_.seed, noise::Stream::camera, 0);
  const auto index = static_cast<std::uint32_t>(count);
  const auto pose_at = [this](double after_s) { return pose_after(after_s); };
  if (sensor_) {
    exposure_s_ = sensor_->exposure_s();
    gain_ = sensor_->gain();
    sensor_->take(std::cref(pose_at), seed, index, buffers_[front_]);  // a reference needs no heap
  } else {
    gain_ = 1.0;
    renderer_->render(pose_at(0.0), seed, index, buffers_[front_]);
  }
  if (settings_.depth) {
    const std::uint64_t depth_seed = noise::bits(settings_.seed, noise::Stream::depth, 0);
    truth_->depth(std::cref(pose_at), 0.5 * exposure_s_, depth_seed, index, depths_[front_]);
  }
  frame_id_ = count;
}

camera::Pose CameraDevice::pose_after(double after_s) const {
  const RigidState then = continued(pictured_.body, after_s);
  bodies_.resize(pictured_.others.size());
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const RigidState other = continued(pictured_.others[i], after_s);
    bodies_[i] = {other.p_WB_m, other.rotation()};
  }
  auto pose = camera::camera_pose(settings_.mounting, then.p_WB_m, then.rotation());
  pose.time_ns = pictured_.time_ns + std::llround(after_s * 1e9);
  pose.bodies = bodies_;
  pose.own_body = pictured_.own;
  return pose;
}

std::span<const std::uint8_t> CameraDevice::frame() const {
  if (frame_id_ == 0) return {};
  return buffers_[front_];
}

std::span<const std::uint8_t> CameraDevice::depth() const {
  if (frame_id_ == 0) return {};
  return depths_[front_];
}

std::string CameraDevice::objects_text() const {
  if (!settings_.labels) return {};
  Json objects = Json::array();
  if (frame_id_ != 0) {
    const auto pose_at = [this](double after_s) { return pose_after(after_s); };
    for (const auto& object : truth_->objects(pose_at, 0.5 * exposure_s_)) objects.push_back(json_of(object));
  }
  return Json{{"frame_id", frame_id_}, {"objects", objects}}.dump();
}

void CameraDevice::Pictured::visit(state::Visitor& v) {
  v("body", body);
  v("others", others);
  v("own", own);
  v("time_ns", time_ns);
}

void CameraDevice::visit(state::Visitor& v) {
  v("last_count", last_count_);
  v("frame_id", frame_id_);
  v("exposure_s", exposure_s_);
  v("gain", gain_);
  if (sensor_) v("sensor", *sensor_);
  // Restores the picture into the unused buffer, so that the bytes of the last picture stay readable.
  if (v.restores()) front_ ^= 1U;
  v("picture", std::span(buffers_[front_]));
  if (settings_.depth) v("depth", std::span(depths_[front_]));
  if (settings_.labels) v("pictured", pictured_);
}

}  // namespace mebots::world
