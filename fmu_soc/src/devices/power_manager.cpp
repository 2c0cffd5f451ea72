// SPDX-License-Identifier: Apache-2.0
#include "devices/power_manager.hpp"

#include "fmu_soc_board/board.hpp"

namespace mebots::soc {

bool PowerManager::load(std::uint32_t offset, Picoseconds /*now*/, std::uint32_t& value) {
  switch (offset) {
    case board::power_manager::kClockHz:
      value = clock_hz_;
      return true;
    case board::power_manager::kVoltageMv:
      value = voltage_mv_;
      return true;
    case board::power_manager::kStatus:
      value = status_;
      return true;
    default:
      return false;
  }
}

bool PowerManager::store(std::uint32_t offset, Picoseconds /*now*/, std::uint32_t value) {
  switch (offset) {
    case board::power_manager::kClockHz:
      if (chip_.allows(value, voltage_mv_)) {
        clock_hz_ = value;
      } else {
        status_ |= kRefused;
      }
      return true;
    case board::power_manager::kVoltageMv:
      if (chip_.allows(clock_hz_, value)) {
        voltage_mv_ = value;
      } else {
        status_ |= kRefused;
      }
      return true;
    case board::power_manager::kStatus:
      status_ &= ~value;
      return true;
    case board::power_manager::kExit:
      exited_ = true;
      exit_code_ = static_cast<std::int32_t>(value);
      return true;
    default:
      return false;
  }
}

void PowerManager::save(state::Writer& writer) const {
  writer.put(clock_hz_);
  writer.put(voltage_mv_);
  writer.put(status_);
  writer.put(exited_);
  writer.put(exit_code_);
}

void PowerManager::restore(state::Reader& reader) {
  reader.get(clock_hz_);
  reader.get(voltage_mv_);
  reader.get(status_);
  reader.get(exited_);
  reader.get(exit_code_);
}

}  // namespace mebots::soc
