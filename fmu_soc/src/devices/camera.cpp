// SPDX-License-Identifier: Apache-2.0
#include "devices/camera.hpp"

#include "fmu_soc_board/board.hpp"
#include "mebots/assert.hpp"

#include <fmt/core.h>

#include <cmath>
#include <type_traits>

namespace mebots::soc {

Camera::Camera(const BoardDevice& device, std::uint32_t frame_width, Memory& memory, Complain complain)
    : idle_w_(device.state("idle").current_a * device.supply_voltage_v),
      active_w_(device.state("active").current_a * device.supply_voltage_v),
      delay_ps_(std::llround(device.state("active").delay_s * kPsPerS)),
      frame_width_(frame_width),
      memory_(memory),
      complain_(std::move(complain)) {
  picture_.reserve(kReservedBytes);
}

void Camera::request() {
  if (busy() || state_.buffer_size == 0 || memory_.find(state_.buffer, state_.buffer_size) == nullptr) {
    state_.status |= kRefused;
    return;
  }
  ++state_.requests;
  MEBOTS_ASSERT(!state_.waiting, "busy until the picture has come");
  state_.status |= kBusy;
  state_.waiting = true;
}

void Camera::offer(std::span<const std::uint8_t> picture, Picoseconds now) {
  MEBOTS_ASSERT(state_.waiting, "ask wants() first");
  picture_.assign(picture.begin(), picture.end());
  state_.waiting = false;
  state_.active_since = now;
  state_.done_at = now + delay_ps_;
}

void Camera::advance(Picoseconds now) {
  if (now >= state_.done_at) finish();
}

void Camera::finish() {
  MEBOTS_ASSERT(state_.done_at != kNever && state_.done_at >= state_.active_since);
  state_.active_total += state_.done_at - state_.active_since;
  state_.done_at = kNever;
  state_.status &= ~kBusy;
  state_.interrupt = true;
  const auto size = static_cast<std::uint32_t>(picture_.size());
  if (size > state_.buffer_size || size % frame_width_ != 0 || !memory_.write(state_.buffer, picture_)) {
    state_.status |= kRefused;
    if (complain_) {
      complain_(fmt::format("picture {} has {} bytes, rows of {}; the firmware's buffer at 0x{:08x} holds {}: dropped",
                            state_.requests, size, frame_width_, state_.buffer, state_.buffer_size));
    }
  } else {
    memory_.changed(state_.buffer, size);
    state_.status |= kReady;
    state_.width = frame_width_;
    state_.height = size / frame_width_;
    state_.frame_id = state_.requests;
  }
  picture_.clear();
}

double Camera::energy_j(Picoseconds now) const {
  const bool active = state_.done_at != kNever;
  const auto active_ps = state_.active_total + (active ? now - state_.active_since : 0);
  MEBOTS_ASSERT(active_ps >= 0 && active_ps <= now);
  return (active_w_ * static_cast<double>(active_ps) + idle_w_ * static_cast<double>(now - active_ps)) / kPsPerS;
}

bool Camera::load(std::uint32_t offset, Picoseconds /*now*/, std::uint32_t& value) {
  switch (offset) {
    case board::camera::kStatus:
      value = state_.status;
      return true;
    case board::camera::kWidth:
      value = state_.width;
      return true;
    case board::camera::kHeight:
      value = state_.height;
      return true;
    case board::camera::kBuffer:
      value = state_.buffer;
      return true;
    case board::camera::kBufferSize:
      value = state_.buffer_size;
      return true;
    case board::camera::kFrameId:
      value = static_cast<std::uint32_t>(state_.frame_id);
      return true;
    default:
      return false;
  }
}

bool Camera::store(std::uint32_t offset, Picoseconds /*now*/, std::uint32_t value) {
  switch (offset) {
    case board::camera::kControl:
      if ((value & 1U) != 0) request();
      return true;
    case board::camera::kStatus:
      state_.status &= ~(value & (kReady | kRefused));
      if ((value & (kReady | kRefused)) != 0) state_.interrupt = false;
      return true;
    case board::camera::kBuffer:
      state_.buffer = value;
      return true;
    case board::camera::kBufferSize:
      state_.buffer_size = value;
      return true;
    default:
      return false;
  }
}

void Camera::visit(state::Visitor& v) {
  v("requests", state_.requests);
  v("status", state_.status);
  v("waiting", state_.waiting);
  v("interrupt", state_.interrupt);
  v("frame_id", state_.frame_id);
  v("done_at", state_.done_at);
  v("active_since", state_.active_since);
  v("active_total", state_.active_total);
  v("buffer", state_.buffer);
  v("buffer_size", state_.buffer_size);
  v("width", state_.width);
  v("height", state_.height);
  v("picture", picture_);
}

}  // namespace mebots::soc
