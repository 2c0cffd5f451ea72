// SPDX-License-Identifier: Apache-2.0
#include "sensors/camera_device.hpp"

#include "mebots/error.hpp"
#include "noise/counter_noise.hpp"

#include <fmt/format.h>
#include <algorithm>

namespace mebots::world {

CameraDevice::CameraDevice(const scene::Scene& scene, const Settings& settings)
    : settings_(settings), renderer_(scene, settings.intrinsics, settings.noise_std) {
  const auto pixels =
      static_cast<std::size_t>(settings.intrinsics.width) * static_cast<std::size_t>(settings.intrinsics.height);
  for (auto& buffer : buffers_) buffer.resize(pixels);
}

void CameraDevice::see_trigger(std::int32_t count, const RigidState& body) {
  if (count == last_count_) return;
  last_count_ = count;
  if (count == 0) return;
  front_ ^= 1U;
  const auto pose = camera::camera_pose(settings_.mounting, body.p_WB_m, body.rotation());
  // The noise belongs to the picture's number, not to the number of pictures taken before it.
  renderer_.render(pose, noise::bits(settings_.seed, noise::Stream::camera, 0), static_cast<std::uint32_t>(count),
                   buffers_[front_]);
  frame_id_ = count;
}

std::span<const std::uint8_t> CameraDevice::frame() const {
  if (frame_id_ == 0) return {};
  return buffers_[front_];
}

void CameraDevice::save(state::Writer& writer) const {
  writer.put(last_count_);
  writer.put(frame_id_);
  writer.put(frame());
}

void CameraDevice::restore(state::Reader& reader) {
  reader.get(last_count_);
  reader.get(frame_id_);
  std::vector<std::uint8_t> bytes;
  reader.get(bytes);
  if (bytes.size() != (frame_id_ == 0 ? 0 : buffers_[0].size())) {
    throw Error(fmt::format("a saved state of fmu_world holds a picture of {} bytes; this camera makes {}",
                            bytes.size(), buffers_[0].size()));
  }
  // A new buffer, as a picture taken would use: the bytes of the one before stay readable.
  front_ ^= 1U;
  std::copy(bytes.begin(), bytes.end(), buffers_[front_].begin());
}

}  // namespace mebots::world
