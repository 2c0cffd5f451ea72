// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/soc/device.hpp"

#include <functional>
#include <string_view>

namespace mebots::soc {

/// The link to the flight controller. Set-points wait in registers until COMMIT sends them all together.
/// A mode that does not exist is not sent: what was sent before stays.
class Flight final : public Device {
 public:
  struct Inputs {
    std::int64_t phase = 0;
    double range_m = 0;
    double forward_velocity_m_per_s = 0;
    double yaw_rad = 0;
    bool gate_passed = false;

    void visit(state::Visitor& v) {
      v("phase", phase);
      v("range_m", range_m);
      v("forward_velocity_m_per_s", forward_velocity_m_per_s);
      v("yaw_rad", yaw_rad);
      v("gate_passed", gate_passed);
    }
  };
  /// What was sent last; words as the firmware wrote them.
  struct SetPoint {
    std::uint32_t mode = 0;
    std::uint32_t velocity_x = 0;  // um/s
    std::uint32_t velocity_y = 0;  // um/s
    std::uint32_t yaw_rate = 0;    // urad/s
    std::uint32_t altitude = 0;    // um

    void visit(state::Visitor& v) {
      v("mode", mode);
      v("velocity_x", velocity_x);
      v("velocity_y", velocity_y);
      v("yaw_rate", yaw_rate);
      v("altitude", altitude);
    }
  };

  using Complain = std::function<void(std::string_view text)>;

  explicit Flight(Complain complain) : complain_(std::move(complain)) {}

  Inputs inputs;
  const SetPoint& sent() const { return sent_; }

  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override;
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override;
  void visit(state::Visitor& v) override;

 private:
  void commit();

  Complain complain_;
  SetPoint draft_;
  SetPoint sent_;
};

}  // namespace mebots::soc
