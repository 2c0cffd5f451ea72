// SPDX-License-Identifier: Apache-2.0
#include "devices/flight.hpp"

#include "fmu_soc_board/board.hpp"
#include "mebots/soc/fixed_point.hpp"

#include <fmt/core.h>

namespace mebots::soc {
namespace {

std::uint32_t* set_point_register(Flight::SetPoint& set_point, std::uint32_t offset) {
  switch (offset) {
    case board::flight::kMode:
      return &set_point.mode;
    case board::flight::kVelocityX:
      return &set_point.velocity_x;
    case board::flight::kVelocityY:
      return &set_point.velocity_y;
    case board::flight::kYawRate:
      return &set_point.yaw_rate;
    case board::flight::kAltitude:
      return &set_point.altitude;
    default:
      return nullptr;
  }
}

}  // namespace

bool Flight::load(std::uint32_t offset, Picoseconds /*now*/, std::uint32_t& value) {
  switch (offset) {
    case board::flight::kPhase:
      value = static_cast<std::uint32_t>(inputs.phase);
      return true;
    case board::flight::kRange:
      value = to_register(inputs.range_m, kMicro);
      return true;
    case board::flight::kForwardVelocity:
      value = to_register(inputs.forward_velocity_m_per_s, kMicro);
      return true;
    case board::flight::kYaw:
      value = to_register(inputs.yaw_rad, kMicro);
      return true;
    case board::flight::kGatePassed:
      value = static_cast<std::uint32_t>(inputs.gate_passed);
      return true;
    default:
      break;
  }
  const auto* word = set_point_register(draft_, offset);
  if (word == nullptr) return false;
  value = *word;
  return true;
}

bool Flight::store(std::uint32_t offset, Picoseconds /*now*/, std::uint32_t value) {
  if (offset == board::flight::kCommit) {
    commit();
    return true;
  }
  auto* word = set_point_register(draft_, offset);
  if (word == nullptr) return false;
  *word = value;
  return true;
}

void Flight::commit() {
  constexpr auto kLastMode = static_cast<std::uint32_t>(board::flight::FlightMode::land);
  const auto altitude_um = static_cast<std::int32_t>(draft_.altitude);
  std::string fault;
  if (draft_.mode > kLastMode) fault = fmt::format("MODE {} is above {}", draft_.mode, kLastMode);
  if (altitude_um < 0) fault = fmt::format("ALTITUDE {} um is below the ground", altitude_um);
  if (fault.empty()) {
    sent_ = draft_;
  } else if (complain_) {
    complain_(fmt::format("flight link: {}: set-points not sent", fault));
  }
}

void Flight::visit(state::Visitor& v) {
  v("inputs", inputs);
  v("draft", draft_);
  v("sent", sent_);
}

}  // namespace mebots::soc
