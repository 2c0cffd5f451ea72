// SPDX-License-Identifier: Apache-2.0
#include "devices/gap8/udma_camera.hpp"

#include "mebots/base64.hpp"
#include "mebots/error.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace mebots::soc::gap8_devices {
namespace {

constexpr std::uint32_t kCameraGlobal = 0x4A0;
constexpr std::uint32_t kCameraLowerLeft = 0x4A4;
constexpr std::uint32_t kCameraUpperRight = 0x4A8;
constexpr std::uint32_t kCameraFilter = 0x4B0;
constexpr std::uint32_t kCameraOn = 1U << 31;
constexpr std::uint32_t kDropsFrames = 1U << 0;
constexpr std::uint32_t kHasWindow = 1U << 7;
constexpr unsigned kFormatShift = 8;
constexpr unsigned kShiftShift = 11;
constexpr std::uint32_t kFormatLittle = 4;
constexpr std::uint32_t kFormatBig = 5;
constexpr std::uint32_t kPixelBytes = 2;  // the interface combines the sensor's bytes in pairs

}  // namespace

UdmaCamera::UdmaCamera(UdmaHost& host, Himax& sensor, const PictureRoll& roll)
    : host_(host), sensor_(sensor), roll_(roll) {
  picture_.reserve(std::size_t{Himax::kWidth} * Himax::kHeight);
  for (const auto& variable : host.entry.variables) {
    if (auto* number = variable.causality == BoardVariable::Causality::parameter ? input(variable.name) : nullptr) {
      *number = variable.start;
    }
  }
}

bool UdmaCamera::is_on() const {
  return (host_.config(kCameraGlobal) & kCameraOn) != 0 && sensor_.streams();
}

InterfaceSettings UdmaCamera::interface_settings() const {
  return {.global = host_.config(kCameraGlobal),
          .lower_left = host_.config(kCameraLowerLeft),
          .upper_right = host_.config(kCameraUpperRight),
          .filter = host_.config(kCameraFilter)};
}

Picoseconds UdmaCamera::end_of_frame() const {
  auto lines = format_.height();
  if ((interface_.global & kHasWindow) != 0) lines = std::min((interface_.upper_right >> 16) + 1, lines);
  return frame_at_ + sensor_.lines_time(lines);
}

Picoseconds UdmaCamera::end_time(const UdmaTransfer& /*transfer*/, Picoseconds start) {
  if (requested_at_ == kNever) requested_at_ = start;
  // This function is called whenever settings of the sensor or the interface change, so that `start` may be the time of
  // such a change. A frame that was already read out is kept, because its picture may arrive after a standby.
  const bool is_same_stream = is_on() && sensor_.first_frame_at() == first_frame_at_;
  if (frame_at_ != kNever && !is_same_stream && start < ends_at_) lose_frame();
  if (frame_at_ == kNever) {
    if (!is_on()) return kNever;
    frame_at_ = sensor_.frame_at(start);
    if (frame_at_ == kNever) return kNever;
    first_frame_at_ = sensor_.first_frame_at();
    light_at_ = std::max(frame_at_ - sensor_.exposure_time(), requested_at_);
  }
  if (start <= frame_at_) {
    format_ = sensor_.format();
    interface_ = interface_settings();
    ends_at_ = end_of_frame();
  }
  advance(start);
  return has_picture_ && start >= stored_at() ? stored_at() : kNever;
}

Picoseconds UdmaCamera::next_event() const {
  if (frame_at_ == kNever) return kNever;
  if (has_picture_) return stored_at();
  return waits_ ? kNever : light_at_;
}

void UdmaCamera::advance(Picoseconds now) {
  if (!has_picture_ && now >= next_event()) expose(light_at_);
}

void UdmaCamera::expose(Picoseconds now) {
  trigger_ = ++requests_;
  if (!roll_.exists()) {
    waits_ = true;
    return;
  }
  const auto picture = roll_.picture(static_cast<std::size_t>(requests_) - 1);
  if (picture.empty()) {
    waits_ = true;  // no picture will arrive; the wait lasts until the end of the run
  } else {
    take(picture, now);
  }
}

void UdmaCamera::take(std::span<const std::uint8_t> picture, Picoseconds now) {
  waits_ = false;
  require_rows(picture.size());
  picture_.assign(picture.begin(), picture.end());
  has_picture_ = true;
  arrived_at_ = now;
}

void UdmaCamera::require_rows(std::size_t bytes) const {
  if (bytes % Himax::kWidth != 0 || bytes / Himax::kWidth < format_.window_height) {
    throw Error(
        fmt::format("{}: picture {} of the camera has {} bytes; this camera needs rows of {} pixels, and at present at "
                    "least {} rows",
                    host_.entry.name, requests_, bytes, Himax::kWidth, format_.window_height));
  }
}

void UdmaCamera::registers_changed(std::uint32_t offset, Picoseconds /*now*/) {
  if (offset == kCameraGlobal && (host_.config(kCameraGlobal) & kDropsFrames) != 0) {
    host_.host.complain(host_.entry.name + ": the camera interface is set to drop frames, which is not modelled");
  }
}

/// Returns a pair of bytes in the interface's format.
std::uint32_t UdmaCamera::converted(std::uint32_t first, std::uint32_t second) const {
  const auto format = interface_.global >> kFormatShift & 7U;
  const auto word = first << 8 | second;
  if (format == kFormatLittle) return word;
  if (format == kFormatBig) return second << 8 | first;
  const auto field = [word](unsigned low, unsigned bits) { return (word >> low & ((1U << bits) - 1)) << (8 - bits); };
  const auto blue = field(0, format == 2 ? 4 : 5);
  const auto green = format == 0 ? field(5, 6) : format == 1 ? field(5, 5) : field(4, 4);
  const auto red = format == 0 ? field(11, 5) : format == 1 ? field(10, 5) : field(8, 4);
  const auto filter = interface_.filter;
  const auto sum = blue * (filter & 0xffU) + green * (filter >> 8 & 0xffU) + red * (filter >> 16 & 0xffU);
  return sum >> (interface_.global >> kShiftShift & 0xfU);
}

/// Converts pixels_ to the window and format of the interface, and stores the bytes in stream_.
void UdmaCamera::convert() {
  const auto lower = interface_.lower_left;
  const auto upper = interface_.upper_right;
  const std::size_t width = format_.width();
  const std::size_t rows = pixels_.size() / width;
  const std::size_t pairs = width / kPixelBytes;
  // The registers count columns in pairs of bytes. The window includes its last row and column.
  const bool has_window = (interface_.global & kHasWindow) != 0;
  const std::size_t first_row = has_window ? lower >> 16 : 0;
  const std::size_t end_row = has_window ? std::min<std::size_t>(rows, (upper >> 16) + 1) : rows;
  const std::size_t first_pair = has_window ? lower & 0xffffU : 0;
  const std::size_t end_pair = has_window ? std::min<std::size_t>(pairs, (upper & 0xffffU) + 1) : pairs;
  stream_.clear();
  stream_.reserve(pixels_.size());
  for (auto row = first_row; row < end_row; ++row) {
    for (auto pair = first_pair; pair < end_pair; ++pair) {
      const auto* at = &pixels_[row * width + pair * kPixelBytes];
      const auto word = converted(at[0], at[1]);
      stream_.push_back(static_cast<std::uint8_t>(word));
      stream_.push_back(static_cast<std::uint8_t>(word >> 8));
    }
  }
}

void UdmaCamera::end(const UdmaTransfer& transfer) {
  require_rows(picture_.size());  // checked again, because the picture may belong to another frame
  format_.read_out(picture_, pixels_);
  convert();
  const PictureTimes times{requested_at_, light_at_, frame_at_, transfer.done_at};
  forget();
  has_picture_ = false;
  if (stream_.size() > transfer.size) stream_.resize(transfer.size);
  if (!host_.host.write_memory(transfer.address, stream_)) {
    host_.complain_of_memory(transfer.address, transfer.size);
    return;
  }
  host_.host.picture_stored(times);
}

void UdmaCamera::cancel(const UdmaTransfer& /*transfer*/, Picoseconds /*now*/) {
  lose_frame();
  forget();
}

/// Discards the frame in progress. If the pictures are from the PictureRoll of a run without a world, keeps the picture
/// for the next frame, because it does not depend on the time.
void UdmaCamera::lose_frame() {
  frame_at_ = kNever;
  if (roll_.exists()) return;
  waits_ = false;
  has_picture_ = false;
}

void UdmaCamera::forget() {
  requested_at_ = kNever;
  frame_at_ = kNever;
}

double* UdmaCamera::input(std::string_view variable) {
  if (variable == "camera.frame_id") return &frame_id_;
  if (variable == "camera.frame_width") return &frame_width_;
  if (variable == "camera.frame_height") return &frame_height_;
  return nullptr;
}

std::string_view* UdmaCamera::text_input(std::string_view variable) {
  return variable == "camera.frame.base64" ? &frame_base64_ : nullptr;
}

std::span<const std::uint8_t>* UdmaCamera::bytes_input(std::string_view variable) {
  return variable == "camera.frame" ? &frame_ : nullptr;
}

const double* UdmaCamera::output(std::string_view variable) const {
  return variable == "camera.trigger" ? &trigger_ : nullptr;
}

void UdmaCamera::begin_step(Picoseconds now) {
  require_parameters();
  if (!waits_ || roll_.exists() || static_cast<std::int32_t>(frame_id_) != requests_) return;
  auto picture = frame_;
  if (picture.empty()) {
    if (!decode_base64(frame_base64_, decoded_)) {
      throw Error(fmt::format("camera.frame.base64 of {} characters is not base64 (RFC 4648)", frame_base64_.size()));
    }
    picture = decoded_;
  }
  if (picture.empty()) return;
  require_size(picture.size());
  take(picture, now);
}

/// Checks the parameters before the first picture arrives. require_size() does not detect every wrong size: 648 x 162
/// pixels have as many bytes as 324 x 324.
void UdmaCamera::require_parameters() const {
  if (frame_width_ == Himax::kWidth && (frame_height_ == 0 || frame_height_ >= Himax::kWindowHeight)) return;
  throw Error(
      fmt::format("{}: camera.frame_width {} and camera.frame_height {}: the sensor needs pictures of {} columns and "
                  "at least {} rows; with camera.frame_height = 0, any number of rows is accepted",
                  host_.entry.name, frame_width_, frame_height_, Himax::kWidth, Himax::kWindowHeight));
}

/// Checks that a picture has frame_width x frame_height bytes. A picture of another width would be garbled.
void UdmaCamera::require_size(std::size_t bytes) const {
  const auto rows = static_cast<std::size_t>(frame_height_);
  if (rows == 0 || bytes == static_cast<std::size_t>(frame_width_) * rows) return;
  throw Error(
      fmt::format("{}: picture {} of the camera has {} bytes, but camera.frame_width and camera.frame_height demand {} "
                  "x {}. Set camera.width and camera.height of the world to these values; with camera.frame_height = "
                  "0, any number of rows is accepted",
                  host_.entry.name, requests_, bytes, frame_width_, rows));
}

void InterfaceSettings::visit(state::Visitor& v) {
  v("global", global);
  v("lower_left", lower_left);
  v("upper_right", upper_right);
  v("filter", filter);
}

void UdmaCamera::visit(state::Visitor& v) {
  v("requests", requests_);
  v("asked_at", requested_at_);
  v("frame_at", frame_at_);
  v("light_at", light_at_);
  v("ends_at", ends_at_);
  v("first_frame_at", first_frame_at_);
  v("format", format_);
  v("interface", interface_);
  v("waits", waits_);
  v("has_picture", has_picture_);
  v("came_at", arrived_at_);
  v("picture", picture_);
  v("frame_id", frame_id_);
  v("frame_width", frame_width_);
  v("frame_height", frame_height_);
  v("trigger", trigger_);
}

}  // namespace mebots::soc::gap8_devices
