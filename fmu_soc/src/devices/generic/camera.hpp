// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/soc/device_kind.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::soc {

/// Models a camera that serves one request at a time:
///
///   CONTROL = 1      The request is counted, and busy is set. The world reads the count and provides the picture.
///   offer()          The picture for that request has arrived. Exposure and read-out start.
///   after the delay  The picture is in the buffer, ready is set, and the interrupt line is raised.
///
/// A request is refused if the buffer is not usable or the camera is busy: the status bit kRefused is set, without an
/// interrupt. A picture is dropped if it does not fit into the buffer, or if it does not have .frame_width times
/// .frame_height pixels: kRefused is set and the interrupt line is raised. The camera draws its active current from
/// offer() to the end of the delay, and otherwise its idle current.
///
/// If the parameter .frame_lines is above 0, the camera has the times of an HM01B0 instead of the delay. A line takes
/// .line_clocks periods of .pixel_clock. The first row is exposed for .exposure_lines lines. Then one row is read out
/// per line. At most one picture is read out per .frame_lines lines.
///
/// All variables begin with the device's name. Inputs: .frame, .frame_id and .frame.base64. Parameters: .frame_width,
/// .frame_height, .frame_lines, .line_clocks, .pixel_clock and .exposure_lines. Output: .trigger.
class Camera final : public Device {
 public:
  static constexpr std::uint32_t kBusy = 1;
  static constexpr std::uint32_t kReady = 2;
  static constexpr std::uint32_t kRefused = 4;
  /// A picture up to this size is stored without a new allocation.
  static constexpr std::size_t kReservedBytes = std::size_t{512} * 512;

  /// Throws Error if the entry lacks the state `idle` or `active`.
  Camera(const BoardDevice& entry, DeviceHost& host);

  /// Returns true if the camera waits for the picture with this number. Otherwise offer() must not be called.
  bool wants(std::int32_t frame_id) const { return state_.waiting && frame_id == state_.requests; }
  void offer(std::span<const std::uint8_t> picture, Picoseconds now);

  /// Returns true from a request until its picture is in the buffer.
  bool busy() const { return (state_.status & kBusy) != 0; }
  bool takes_picture() const override { return busy(); }
  std::int32_t requests() const { return state_.requests; }
  double energy_j(Picoseconds now) const override;

  double* input(std::string_view variable) override;
  std::string_view* text_input(std::string_view variable) override;
  std::span<const std::uint8_t>* bytes_input(std::string_view variable) override;
  const double* output(std::string_view variable) const override;
  /// Starts exposure and read-out if the requested picture has arrived.
  void begin_step(Picoseconds now) override;

  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override;
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override;
  void advance(Picoseconds now) override;
  Picoseconds next_event() const override { return state_.done_at; }
  bool interrupt() const override { return state_.interrupt; }
  std::string_view state_name() const override {
    return state_.done_at != kNever ? "active" : state_.waiting ? "waiting for the picture" : "idle";
  }
  void visit(state::Visitor& v) override;

 private:
  struct State {
    std::int32_t requests = 0;
    std::uint32_t status = 0;
    bool waiting = false;  // true while a request waits for its picture
    bool interrupt = false;
    bool warned_of_format = false;  // true after a picture of another size was reported
    std::int32_t frame_id = 0;
    Picoseconds requested_at = 0;
    Picoseconds done_at = kNever;
    std::optional<Picoseconds> read_out_at;  // start of the read-out of the present or last picture
    Picoseconds active_since = 0;
    Picoseconds active_total = 0;  // active time up to the end of the last activity
    std::uint32_t buffer = 0;
    std::uint32_t buffer_size = 0;
    std::uint32_t width = 0;
    std::uint32_t height = 0;
  };

  void request(Picoseconds now);
  void finish();
  void time_lines(Picoseconds now);

  const BoardDevice& entry_;
  DeviceHost& host_;
  double idle_w_;
  double active_w_;
  Picoseconds delay_ps_;  // time for exposure and read-out; only used if .frame_lines is 0
  State state_;
  std::vector<std::uint8_t> picture_;

  // Variables of the FMU.
  double frame_id_ = 0;
  double frame_width_ = 0;
  double frame_height_ = 0;
  double frame_lines_ = 0;
  double line_clocks_ = 376;
  double pixel_clock_hz_ = 6e6;
  double exposure_lines_ = 0;
  double trigger_ = 0;
  std::span<const std::uint8_t> frame_;
  std::string_view frame_base64_;
  std::vector<std::uint8_t> decoded_;  // decoded .frame.base64; a member only so that its memory is reused
};

}  // namespace mebots::soc
