// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "chip.hpp"
#include "clock.hpp"

#include "mebots/state/bytes.hpp"

#include <array>
#include <cstdint>
#include <string_view>

namespace mebots::soc {

struct EnergyComponent {
  std::string_view name;
  double energy_j = 0;
};

/// Joules of the chip by component, since reset.
struct EnergyLedger {
  double core_active_j = 0;
  double memory_j = 0;
  double leakage_j = 0;

  double total_j() const { return core_active_j + memory_j + leakage_j; }
  /// The parts of the total with their names, for whoever shows them.
  std::array<EnergyComponent, 3> components() const {
    return {{{"core_active", core_active_j}, {"memory", memory_j}, {"leakage", leakage_j}}};
  }
};

/// What the energy of a span of time follows from: counts and durations, all integers.
struct Activity {
  std::uint64_t instruction_fj = 0;  // at the reference voltage
  std::uint64_t memory_accesses = 0;
  std::uint64_t device_accesses = 0;
  Picoseconds powered = 0;
  Picoseconds asleep = 0;
};

/// Turns activity into energy. Dynamic energy goes with the square of the voltage. While the voltage stays the
/// same, energy is computed from the integers since its last change, never summed up step by step: the result
/// does not depend on how often somebody looks.
class EnergyMeter {
 public:
  EnergyMeter(const Chip& chip, std::uint32_t memory_bytes, double voltage_v);

  EnergyLedger at(const Activity& now) const;
  /// From `now` on, the core has another voltage.
  void change_voltage(double voltage_v, const Activity& now);

  void save(state::Writer& writer) const;
  void restore(state::Reader& reader);

 private:
  const Chip& chip_;
  double memory_leakage_w_;
  double dynamic_scale_ = 1;
  Activity since_;        // at the last change of voltage
  EnergyLedger settled_;  // up to then
};

}  // namespace mebots::soc
