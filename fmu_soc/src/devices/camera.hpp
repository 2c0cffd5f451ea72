// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board_file.hpp"
#include "mebots/soc/device.hpp"
#include "memory/memory.hpp"

#include <cstddef>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

namespace mebots::soc {

/// A camera that answers one request at a time:
///
///   CONTROL = 1   the request is counted; busy. The surroundings see the count and make the picture.
///   offer()       the picture with that count has come: exposure and read-out start.
///   + delay       the picture stands in the buffer, ready is set, the interrupt line goes up.
///
/// A request without a usable buffer, or while busy, is refused on the spot: the bit is set, no interrupt. A picture
/// that does not fit when it comes is dropped: refused is set, and the line goes up, so that nobody waits for ever. The
/// camera draws its active current from offer() to the end, its idle current otherwise.
class Camera final : public Device {
 public:
  static constexpr std::uint32_t kBusy = 1;
  static constexpr std::uint32_t kReady = 2;
  static constexpr std::uint32_t kRefused = 4;
  /// Pictures up to this size are held without taking memory from the heap.
  static constexpr std::size_t kReservedBytes = std::size_t{512} * 512;

  using Complain = std::function<void(std::string_view text)>;

  Camera(const BoardDevice& device, std::uint32_t frame_width, Memory& memory, Complain complain);

  /// A picture is there at the start of a step. Taken when it answers the request; returns whether it was.
  bool wants(std::int32_t frame_id) const { return state_.waiting && frame_id == state_.requests; }
  void offer(std::span<const std::uint8_t> picture, Picoseconds now);

  /// From a request to the end of its picture.
  bool busy() const { return (state_.status & kBusy) != 0; }
  /// Requests since reset.
  std::int32_t requests() const { return state_.requests; }
  /// Energy since reset [J], at `now`.
  double energy_j(Picoseconds now) const;

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
    bool waiting = false;  // for the picture
    bool interrupt = false;
    std::int32_t frame_id = 0;
    Picoseconds done_at = kNever;
    Picoseconds active_since = 0;
    Picoseconds active_total = 0;  // up to the last end
    std::uint32_t buffer = 0;
    std::uint32_t buffer_size = 0;
    std::uint32_t width = 0;
    std::uint32_t height = 0;
  };

  void request();
  void finish();

  double idle_w_;
  double active_w_;
  Picoseconds delay_ps_;
  std::uint32_t frame_width_;
  Memory& memory_;
  Complain complain_;
  State state_;
  std::vector<std::uint8_t> picture_;
};

}  // namespace mebots::soc
