// SPDX-License-Identifier: Apache-2.0
#include "energy.hpp"

namespace mebots::soc {
namespace {

constexpr double kFemtojoule = 1e-15;
constexpr double kPicosecond = 1e-12;

double dynamic_scale(const Chip& chip, double voltage_v) {
  const auto ratio = voltage_v / chip.reference_voltage_v;
  return ratio * ratio;
}

}  // namespace

EnergyMeter::EnergyMeter(const Chip& chip, std::uint32_t memory_bytes, double voltage_v)
    : chip_(chip),
      memory_leakage_w_(chip.memory_leakage_w_per_byte * memory_bytes),
      dynamic_scale_(dynamic_scale(chip, voltage_v)) {}

EnergyLedger EnergyMeter::at(const Activity& now) const {
  const auto instructions_j = static_cast<double>(now.instruction_fj - since_.instruction_fj) * kFemtojoule;
  const auto memory_j = static_cast<double>(now.memory_accesses - since_.memory_accesses) * chip_.memory_access_j +
                        static_cast<double>(now.device_accesses - since_.device_accesses) * chip_.device_access_j;
  const auto powered_s = static_cast<double>(now.powered - since_.powered) * kPicosecond;
  const auto asleep_s = static_cast<double>(now.asleep - since_.asleep) * kPicosecond;
  EnergyLedger ledger = settled_;
  ledger.core_active_j += instructions_j * dynamic_scale_;
  ledger.memory_j += memory_j * dynamic_scale_;
  ledger.leakage_j +=
      (chip_.core_leakage_w + memory_leakage_w_) * powered_s + chip_.core_clock_gated_w * dynamic_scale_ * asleep_s;
  return ledger;
}

void EnergyMeter::change_voltage(double voltage_v, const Activity& now) {
  settled_ = at(now);
  since_ = now;
  dynamic_scale_ = dynamic_scale(chip_, voltage_v);
}

void EnergyMeter::save(state::Writer& writer) const {
  writer.put(dynamic_scale_);
  writer.put(since_);
  writer.put(settled_);
}

void EnergyMeter::restore(state::Reader& reader) {
  reader.get(dynamic_scale_);
  reader.get(since_);
  reader.get(settled_);
}

}  // namespace mebots::soc
