// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "devices/readings.hpp"
#include "fmu_soc_board/board.hpp"
#include "mebots/soc/fixed_point.hpp"

namespace mebots::soc {

/// Parameters of the flight application, which the firmware reads as it would read them from flash.
class MissionParameters final : public Readings<board::mission::kRegisters.size()> {
 public:
  struct Values {
    double cruise_speed_m_per_s = 0;
    double altitude_m = 0;
    double frame_period_s = 0;
    double yaw_rate_scale_rad_per_s = 0;
    double landing_charge = 0;
    std::int32_t policy = 0;
    double initial_speed_m_per_s = 0;
    std::int32_t navigator = 0;
    double sleep_clock_hz = 10e6;
  };

  explicit MissionParameters(const Values& values) {
    set(board::mission::kCruiseSpeed, to_register(values.cruise_speed_m_per_s, kMicro));
    set(board::mission::kAltitude, to_register(values.altitude_m, kMicro));
    set(board::mission::kFramePeriod, to_register(values.frame_period_s, kMicro));
    set(board::mission::kYawRateScale, to_register(values.yaw_rate_scale_rad_per_s, kMicro));
    set(board::mission::kLandingCharge, to_register(values.landing_charge, kMicro));
    set(board::mission::kPolicy, static_cast<std::uint32_t>(values.policy));
    set(board::mission::kInitialSpeed, to_register(values.initial_speed_m_per_s, kMicro));
    set(board::mission::kNavigator, static_cast<std::uint32_t>(values.navigator));
    set(board::mission::kSleepClock, to_register(values.sleep_clock_hz, 1.0));
  }
};

}  // namespace mebots::soc
