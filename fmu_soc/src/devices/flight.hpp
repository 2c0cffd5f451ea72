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
    std::int64_t gate_passed = 0;  ///< 0 or 1; a word, so that no byte of a saved state is padding
  };
  /// What was sent last; words as the firmware wrote them.
  struct SetPoint {
    std::uint32_t mode = 0;
    std::uint32_t velocity_x = 0;  // um/s
    std::uint32_t velocity_y = 0;  // um/s
    std::uint32_t yaw_rate = 0;    // urad/s
    std::uint32_t altitude = 0;    // um
  };

  using Complain = std::function<void(std::string_view text)>;

  explicit Flight(Complain complain) : complain_(std::move(complain)) {}

  Inputs inputs;
  const SetPoint& sent() const { return sent_; }

  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override;
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override;
  void save(state::Writer& writer) const override;
  void restore(state::Reader& reader) override;

 private:
  void commit();

  Complain complain_;
  SetPoint draft_;
  SetPoint sent_;
};

}  // namespace mebots::soc
