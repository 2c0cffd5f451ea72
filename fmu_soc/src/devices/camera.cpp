// SPDX-License-Identifier: Apache-2.0
#include "devices/camera.hpp"

#include "base64.hpp"
#include "fmu_soc_board/board.hpp"
#include "mebots/assert.hpp"
#include "mebots/error.hpp"

#include <fmt/core.h>

#include <cmath>
#include <type_traits>

namespace mebots::soc {

Camera::Camera(const BoardDevice& entry, DeviceHost& host)
    : entry_(entry),
      host_(host),
      idle_w_(entry.state("idle").current_a * entry.supply_voltage_v),
      active_w_(entry.state("active").current_a * entry.supply_voltage_v),
      delay_ps_(std::llround(entry.state("active").delay_s * kPsPerS)),
      read_out_ps_(delay_ps_) {
  picture_.reserve(kReservedBytes);
  if (const auto* width = entry.variable(entry.name + ".frame_width")) frame_width_ = width->start;
}

double* Camera::input(std::string_view variable) {
  if (variable == entry_.name + ".frame_id") return &frame_id_;
  if (variable == entry_.name + ".frame_width") return &frame_width_;
  return nullptr;
}

std::string_view* Camera::text_input(std::string_view variable) {
  return variable == entry_.name + ".frame.base64" ? &frame_base64_ : nullptr;
}

std::span<const std::uint8_t>* Camera::bytes_input(std::string_view variable) {
  return variable == entry_.name + ".frame" ? &frame_ : nullptr;
}

const double* Camera::output(std::string_view variable) const {
  return variable == entry_.name + ".trigger" ? &trigger_ : nullptr;
}

void Camera::begin_step(Picoseconds now) {
  if (!wants(static_cast<std::int32_t>(frame_id_))) return;
  auto picture = frame_;
  if (picture.empty()) {
    if (!decode_base64(frame_base64_, decoded_)) {
      throw Error(
          fmt::format("{}.frame.base64 of {} characters is not base64 (RFC 4648)", entry_.name, frame_base64_.size()));
    }
    picture = decoded_;
  }
  if (!picture.empty()) offer(picture, now);
}

void Camera::request(Picoseconds now) {
  if (busy() || state_.buffer_size == 0 || !host_.is_memory(state_.buffer, state_.buffer_size)) {
    state_.status |= kRefused;
    return;
  }
  trigger_ = ++state_.requests;
  state_.asked_at = now;
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
  const auto stored = state_.done_at;
  state_.done_at = kNever;
  state_.status &= ~kBusy;
  state_.interrupt = true;
  const auto size = static_cast<std::uint32_t>(picture_.size());
  const auto width = static_cast<std::uint32_t>(frame_width_);
  if (size > state_.buffer_size || width == 0 || size % width != 0 || !host_.write_memory(state_.buffer, picture_)) {
    state_.status |= kRefused;
    host_.complain(
        fmt::format("picture {} has {} bytes, rows of {}; the firmware's buffer at 0x{:08x} holds {}: dropped",
                    state_.requests, size, width, state_.buffer, state_.buffer_size));
  } else {
    state_.status |= kReady;
    state_.width = width;
    state_.height = size / width;
    state_.frame_id = state_.requests;
    host_.picture_stored({state_.asked_at, state_.active_since, stored - read_out_ps_, stored});
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

bool Camera::store(std::uint32_t offset, Picoseconds now, std::uint32_t value) {
  switch (offset) {
    case board::camera::kControl:
      if ((value & 1U) != 0) request(now);
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
  v("asked_at", state_.asked_at);
  v("done_at", state_.done_at);
  v("active_since", state_.active_since);
  v("active_total", state_.active_total);
  v("buffer", state_.buffer);
  v("buffer_size", state_.buffer_size);
  v("width", state_.width);
  v("height", state_.height);
  v("picture", picture_);
  v("frame_id_input", frame_id_);
  v("frame_width", frame_width_);
  v("trigger", trigger_);
}

}  // namespace mebots::soc
