// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board/settings.hpp"
#include "energy/meter.hpp"
#include "soc/device_set.hpp"
#include "soc/hardware.hpp"
#include "soc/timeline.hpp"

#include <cstdint>

namespace mebots::soc {

/// Computes the energy of a chip, and stores its voltage.
class PowerAccount {
 public:
  PowerAccount(const Hardware& hardware, const Timeline& timeline, const Settings& settings);

  /// Returns the energy from the start to `time`, which may be later than the present time.
  EnergyLedger energy_at(Picoseconds time) const;
  /// Returns the energy up to the start of the fabric controller's next instruction or of its sleep. Observers call
  /// this function during a run.
  EnergyLedger energy_at_core() const { return energy_at(timeline_.core_time()); }
  /// Returns the energy that a device has used since the start [J].
  double energy_j(const Device& device) const { return device.energy_j(timeline_.supplied_until(timeline_.now())); }
  /// Returns the energy that a cluster core has used since the start, without the energy of its gated clock [J].
  double cluster_core_energy_j(unsigned core) const { return meter_.core_j(core, core_activity(core)); }
  /// Returns by how much the total energy increases at the present settings if one count of a hart, such as
  /// instructions or accesses, increases by one.
  CountEnergy energy_per_count(unsigned hart) const;
  /// Returns the number of words that refills transfer per cycle in which the fabric controller waits for its
  /// instruction cache.
  double refill_words_per_fetch_cycle() const;

  double clock_hz() const { return timeline_.clock().hz(); }
  std::uint32_t voltage_mv() const { return voltage_mv_; }
  double voltage_v() const { return voltage_mv_ / 1e3; }
  Activity activity_at(Picoseconds now) const;
  void set_voltage(std::uint32_t voltage_mv) { voltage_mv_ = voltage_mv; }
  /// Must be called after clocks or voltage have changed. `before` is the activity up to the change.
  void change(const Activity& before) { meter_.change(power_state(), before); }

  void visit(state::Visitor& v);

 private:
  PowerState power_state() const;
  CoreActivity core_activity(unsigned core) const;

  const Hardware& hardware_;
  const Timeline& timeline_;
  EnergyMeter meter_;
  double temperature_c_;
  std::uint32_t voltage_mv_;
};

}  // namespace mebots::soc
