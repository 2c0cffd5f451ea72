// SPDX-License-Identifier: Apache-2.0
#include "devices/generic/power_manager.hpp"

#include "devices/core/kinds.hpp"
#include "fmu_soc_board/board.hpp"

namespace mebots::soc {

namespace reg = board::power_manager;

bool PowerManager::load(std::uint32_t offset, Picoseconds /*now*/, std::uint32_t& value) {
  switch (offset) {
    case reg::kClockHz:
      value = settings_.clock_hz;
      return true;
    case reg::kVoltageMv:
      value = settings_.voltage_mv;
      return true;
    case reg::kStatus:
      value = status_;
      return true;
    case reg::kClusterPower:
      value = settings_.cluster_on;
      return true;
    case reg::kClusterBoot:
      value = settings_.cluster_boot;
      return true;
    case reg::kClusterClockHz:
      value = settings_.cluster_clock_hz;
      return true;
    case reg::kRetention:
      value = settings_.retention;
      return true;
    default:
      return false;
  }
}

/// Changes a setting. If the new settings would exceed a limit, changes nothing and sets the refused bit.
void PowerManager::change(std::uint32_t PowerSettings::*what, std::uint32_t value) {
  auto wanted = settings_;
  wanted.*what = value;
  const bool good = chip_.allows(wanted.clock_hz, wanted.voltage_mv) &&
                    (!has_cluster_ || chip_.allows_cluster(wanted.cluster_clock_hz, wanted.voltage_mv)) &&
                    wanted.cluster_on <= (has_cluster_ ? 1U : 0U) && wanted.retention + wanted.cluster_on <= 1 &&
                    wanted.retention <= 1;
  if (good) {
    settings_ = wanted;
  } else {
    status_ |= kRefused;
  }
}

bool PowerManager::store(std::uint32_t offset, Picoseconds /*now*/, std::uint32_t value) {
  switch (offset) {
    case reg::kClockHz:
      change(&PowerSettings::clock_hz, value);
      return true;
    case reg::kVoltageMv:
      change(&PowerSettings::voltage_mv, value);
      return true;
    case reg::kStatus:
      status_ &= ~value;
      return true;
    case reg::kExit:
      exited_ = true;
      exit_code_ = static_cast<std::int32_t>(value);
      return true;
    case reg::kClusterPower:
      change(&PowerSettings::cluster_on, value);
      return true;
    case reg::kClusterBoot:
      settings_.cluster_boot = value;
      return true;
    case reg::kClusterClockHz:
      change(&PowerSettings::cluster_clock_hz, value);
      return true;
    case reg::kRetention:
      change(&PowerSettings::retention, value);
      return true;
    default:
      return false;
  }
}

void PowerManager::visit(state::Visitor& v) {
  v("settings", settings_);
  v("status", status_);
  v("exited", exited_);
  v("exit_code", exit_code_);
}

}  // namespace mebots::soc

MEBOTS_CHIP_KIND(power_manager, board::power_manager::kRegisters,
                 [](const BoardDevice& /*entry*/, ChipHost& host) -> std::unique_ptr<Device> {
                   return std::make_unique<PowerManager>(host.chip(), host.power_at_start(), host.has_cluster());
                 })
