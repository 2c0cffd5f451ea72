// SPDX-License-Identifier: Apache-2.0
#include "sensors/camera_device.hpp"

#include "mebots/assert.hpp"
#include "noise/counter_noise.hpp"

namespace mebots::world {

CameraDevice::CameraDevice(const scene::Scene& scene, const Settings& settings)
    : settings_(settings), renderer_(scene, settings.intrinsics, settings.noise_std) {
  const auto pixels =
      static_cast<std::size_t>(settings.intrinsics.width) * static_cast<std::size_t>(settings.intrinsics.height);
  for (auto& buffer : buffers_) buffer.resize(pixels);
}

void CameraDevice::see_trigger(std::int32_t count, const RigidState& body, std::int64_t time_ns) {
  if (count == last_count_) return;
  last_count_ = count;
  if (count == 0) return;
  front_ ^= 1U;
  auto pose = camera::camera_pose(settings_.mounting, body.p_WB_m, body.rotation());
  pose.time_ns = time_ns;
  // The noise belongs to the picture's number, not to the number of pictures taken before it.
  MEBOTS_ASSERT(front_ < buffers_.size());
  renderer_.render(pose, noise::bits(settings_.seed, noise::Stream::camera, 0), static_cast<std::uint32_t>(count),
                   buffers_[front_]);
  frame_id_ = count;
}

std::span<const std::uint8_t> CameraDevice::frame() const {
  if (frame_id_ == 0) return {};
  return buffers_[front_];
}

void CameraDevice::visit(state::Visitor& v) {
  v("last_count", last_count_);
  v("frame_id", frame_id_);
  // Into a new buffer, as a picture taken would: the bytes of the one before stay readable.
  if (v.restores()) front_ ^= 1U;
  v("picture", std::span(buffers_[front_]));
}

}  // namespace mebots::world
