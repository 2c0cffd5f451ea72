// SPDX-License-Identifier: Apache-2.0
#include "devices/generic/camera.hpp"

#include "devices/core/kinds.hpp"
#include "fmu_soc_board/board.hpp"
#include "mebots/assert.hpp"
#include "mebots/base64.hpp"
#include "mebots/error.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace mebots::soc {
namespace {

/// An exposure must be shorter than its frame by at least this number of lines. Source: data sheet of the HM01B0, as
/// used in nanocockpit's driver (himax.c).
constexpr double kBlankLines = 2;

}  // namespace

Camera::Camera(const BoardDevice& entry, DeviceHost& host)
    : entry_(entry),
      host_(host),
      idle_w_(entry.state("idle").current_a * entry.supply_voltage_v),
      active_w_(entry.state("active").current_a * entry.supply_voltage_v),
      delay_ps_(std::llround(entry.state("active").delay_s * kPsPerS)) {
  picture_.reserve(kReservedBytes);
  for (const auto& variable : entry.variables) {
    if (auto* number = variable.is_number() && variable.causality == BoardVariable::Causality::parameter
                           ? input(variable.name)
                           : nullptr) {
      *number = variable.start;
    }
  }
}

double* Camera::input(std::string_view variable) {
  if (variable == entry_.name + ".frame_id") return &frame_id_;
  if (variable == entry_.name + ".frame_width") return &frame_width_;
  if (variable == entry_.name + ".frame_height") return &frame_height_;
  if (variable == entry_.name + ".frame_lines") return &frame_lines_;
  if (variable == entry_.name + ".line_clocks") return &line_clocks_;
  if (variable == entry_.name + ".pixel_clock") return &pixel_clock_hz_;
  if (variable == entry_.name + ".exposure_lines") return &exposure_lines_;
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
  state_.requested_at = now;
  MEBOTS_ASSERT(!state_.waiting, "busy until the picture has come");
  state_.status |= kBusy;
  state_.waiting = true;
}

void Camera::offer(std::span<const std::uint8_t> picture, Picoseconds now) {
  MEBOTS_ASSERT(state_.waiting, "ask wants() first");
  picture_.assign(picture.begin(), picture.end());
  state_.waiting = false;
  if (frame_lines_ > 0) return time_lines(now);
  state_.active_since = now;
  state_.read_out_at = now;
  state_.done_at = now + delay_ps_;
}

/// Computes the times of exposure and read-out from numbers of lines. Read-outs start at least `frame_lines_` lines
/// apart.
void Camera::time_lines(Picoseconds now) {
  const auto rows = frame_width_ > 0 ? static_cast<double>(picture_.size()) / frame_width_ : 0;
  if (rows > frame_lines_ || exposure_lines_ > frame_lines_ - kBlankLines) {
    throw Error(
        fmt::format("{0}.frame_lines {1} is too few for pictures of {2} rows and {0}.exposure_lines {3}: it must be at "
                    "least the number of rows, and at least the exposure plus {4}",
                    entry_.name, frame_lines_, rows, exposure_lines_, kBlankLines));
  }
  const auto lines = [this](double count) {
    return static_cast<Picoseconds>(std::llround(count * line_clocks_ / pixel_clock_hz_ * kPsPerS));
  };
  auto read_out_at = now + lines(exposure_lines_);
  if (state_.read_out_at) read_out_at = std::max(read_out_at, *state_.read_out_at + lines(frame_lines_));
  state_.read_out_at = read_out_at;
  state_.active_since = read_out_at - lines(exposure_lines_);
  state_.done_at = read_out_at + lines(rows);
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
  // A picture of another size would be garbled, because the number of rows does not follow from the number of bytes.
  if (const auto height = static_cast<std::uint32_t>(frame_height_); height != 0 && size != width * height) {
    state_.status |= kRefused;
    if (!state_.warned_of_format) {
      state_.warned_of_format = true;
      host_.complain(
          fmt::format("picture {0} has {1} bytes, but {3}.frame_width {4} and {3}.frame_height {5} make {2}. Pictures "
                      "of another size are dropped. Set {3}.frame_width and {3}.frame_height to camera.width and "
                      "camera.height of the world; with {3}.frame_height = 0, any number of rows is accepted",
                      state_.requests, size, width * height, entry_.name, width, height));
    }
  } else if (size > state_.buffer_size || width == 0 || size % width != 0 ||
             !host_.write_memory(state_.buffer, picture_)) {
    state_.status |= kRefused;
    host_.complain(fmt::format(
        "picture {} was dropped: it has {} bytes in rows of {}, and the firmware's buffer at 0x{:08x} holds {}",
        state_.requests, size, width, state_.buffer, state_.buffer_size));
  } else {
    state_.status |= kReady;
    state_.width = width;
    state_.height = size / width;
    state_.frame_id = state_.requests;
    host_.picture_stored({state_.requested_at, state_.active_since, *state_.read_out_at, stored});
  }
  picture_.clear();
}

double Camera::energy_j(Picoseconds now) const {
  const bool active = state_.done_at != kNever && now > state_.active_since;
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
  v("told_format", state_.warned_of_format);
  v("frame_id", state_.frame_id);
  v("asked_at", state_.requested_at);
  v("done_at", state_.done_at);
  v("read_out_at", state_.read_out_at);
  v("active_since", state_.active_since);
  v("active_total", state_.active_total);
  v("buffer", state_.buffer);
  v("buffer_size", state_.buffer_size);
  v("width", state_.width);
  v("height", state_.height);
  v("picture", picture_);
  v("frame_id_input", frame_id_);
  v("frame_width", frame_width_);
  v("frame_height", frame_height_);
  v("frame_lines", frame_lines_);
  v("line_clocks", line_clocks_);
  v("pixel_clock", pixel_clock_hz_);
  v("exposure_lines", exposure_lines_);
  v("trigger", trigger_);
}

}  // namespace mebots::soc

MEBOTS_CHIP_KIND(camera, board::camera::kRegisters, make_of_entry<Camera>)
