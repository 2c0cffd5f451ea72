// SPDX-License-Identifier: Apache-2.0
#include "energy/meter.hpp"

#include "mebots/assert.hpp"
#include "mebots/data/object.hpp"

namespace mebots::soc {
namespace {

constexpr double kPicojoule = 1e-12;
constexpr double kPicosecond = 1e-12;
constexpr double kBankBytes = 4096;

double count(std::uint64_t now, std::uint64_t before) {
  MEBOTS_ASSERT(now >= before, "counts only grow");
  return static_cast<double>(now - before);
}
double seconds(Picoseconds now, Picoseconds before) {
  MEBOTS_ASSERT(now >= before, "time does not go back");
  return static_cast<double>(now - before) * kPicosecond;
}

}  // namespace

double EnergyLedger::total_j() const {
  return core_active_j() + memory_j() + standing_j();
}

double EnergyLedger::standing_j() const {
  return (*this)[Part::fc_background] + (*this)[Part::cluster_background] + (*this)[Part::leakage] +
         (*this)[Part::retention];
}

std::array<EnergyComponent, kParts> EnergyLedger::components() const {
  std::array<EnergyComponent, kParts> found;
  for (std::size_t i = 0; i < kParts; ++i) found[i] = {kPartNames[i], by_part_j[i]};
  return found;
}

double EnergyLedger::core_active_j() const {
  return (*this)[Part::fabric_controller] + (*this)[Part::cluster_cores];
}

double EnergyLedger::memory_j() const {
  return (*this)[Part::fc_memory] + (*this)[Part::l2] + (*this)[Part::l1] + (*this)[Part::interconnect] +
         (*this)[Part::dma];
}

EnergyTables EnergyTables::read(const data::Node& node) {
  EnergyTables tables;
  data::Object object(node);
  const auto table = [&](std::string_view key, EnergyTable& into, std::string_view unit) {
    const double scale = unit == "pJ" ? kPicojoule : 1;
    return object.read(key, into, [&](const data::Node& member) { return EnergyTable::read(member, unit, scale); });
  };
  const bool has_instruction = table("instruction", tables.instruction, "pJ");
  table("core_clock_gated", tables.core_clock_gated, "W");
  table("core_leakage", tables.core_leakage, "W");
  table("memory_access", tables.memory_access, "pJ");
  table("l1_access", tables.l1_access, "pJ");
  table("memory_leakage", tables.memory_leakage, "W");
  table("interconnect_word", tables.interconnect_word, "pJ");
  table("dma_active", tables.dma_active, "W");
  table("dma_background", tables.dma_background, "W");
  table("fc_background", tables.fc_background, "W");
  table("cluster_background", tables.cluster_background, "W");
  table("cluster_leakage", tables.cluster_leakage, "W");
  OperatingPoint reference;
  const auto positive = data::Limits::positive();
  bool has_reference = object.read("reference_temperature", reference.temperature_c, data::quantity("degC"));
  has_reference &= object.read("reference_voltage", reference.voltage_v, data::quantity("V", positive));
  object.read("retention_voltage", tables.retention_voltage_v, data::quantity("V", positive));
  object.finish();
  if (has_instruction && has_reference) {
    tables.reference_instruction_j = tables.instruction.at(reference);
    if (!(tables.reference_instruction_j > 0)) {
      node.at("instruction").complain(ErrorCode::invalid_value, "this must be above 0 at the reference point");
    }
  }
  return tables;
}

EnergyMeter::EnergyMeter(const EnergyTables& tables, const Inventory& inventory, const PowerState& state)
    : tables_(tables), inventory_(inventory), state_(state), rates_(rates_at(state)) {}

EnergyMeter::Rates EnergyMeter::rates_at(const PowerState& state) const {
  const OperatingPoint fc{state.temperature_c, state.voltage_v, state.clock_hz};
  const OperatingPoint cluster{state.temperature_c, state.voltage_v, state.cluster_clock_hz};
  const OperatingPoint retention{state.temperature_c, tables_.retention_voltage_v, 0};
  const auto fc_banks = inventory_.fc_memory_bytes / kBankBytes;
  MEBOTS_ASSERT(tables_.reference_instruction_j > 0);
  Rates rates;
  const auto at = [this](const EnergyTable& table, const OperatingPoint& point) {
    return tables_.scale * table.at(point);
  };
  rates.instruction = at(tables_.instruction, fc) / tables_.reference_instruction_j;
  rates.core_gated_w = at(tables_.core_clock_gated, fc);
  rates.memory_access_j = at(tables_.memory_access, fc);
  rates.far_word_j = at(tables_.interconnect_word, fc);
  rates.fc_background_w = at(tables_.fc_background, fc);
  rates.leakage_w = at(tables_.core_leakage, fc) + at(tables_.memory_leakage, fc) * fc_banks;
  rates.retention_w = at(tables_.memory_leakage, retention) * fc_banks;
  if (inventory_.cluster_cores == 0) return rates;
  rates.l1_access_j = at(tables_.l1_access, cluster);
  rates.dma_active_w = at(tables_.dma_active, cluster);
  rates.dma_background_w = at(tables_.dma_background, cluster);
  rates.cluster_background_w = at(tables_.cluster_background, cluster);
  rates.cluster_leakage_w = at(tables_.cluster_leakage, cluster) +
                            at(tables_.core_leakage, cluster) * inventory_.cluster_cores +
                            at(tables_.memory_leakage, cluster) * inventory_.l1_bytes / kBankBytes;
  return rates;
}

EnergyLedger EnergyMeter::at(const Activity& now) const {
  const auto awake_s = seconds(now.powered - now.retained, since_.powered - since_.retained);
  const auto cluster_s = seconds(now.cluster_powered, since_.cluster_powered);
  const auto per_cluster_cycle_s = inventory_.cluster_cores == 0 ? 0.0 : 1 / state_.cluster_clock_hz;
  const auto cluster_asleep_s =
      inventory_.cluster_cores * cluster_s - count(now.cluster_cycles, since_.cluster_cycles) * per_cluster_cycle_s;
  const auto instruction_j = rates_.instruction * kFemtojoule;
  EnergyLedger ledger = settled_;
  ledger[Part::fabric_controller] +=
      count(now.fc_instruction_fj, since_.fc_instruction_fj) * instruction_j +
      rates_.core_gated_w * seconds(now.fc_asleep - now.retained, since_.fc_asleep - since_.retained);
  ledger[Part::cluster_cores] += count(now.cluster_instruction_fj, since_.cluster_instruction_fj) * instruction_j +
                                 rates_.core_gated_w * cluster_asleep_s;
  ledger[Part::fc_memory] += count(now.fc_memory_accesses, since_.fc_memory_accesses) * rates_.memory_access_j;
  ledger[Part::l2] += count(now.l2_accesses, since_.l2_accesses) * rates_.memory_access_j;
  ledger[Part::l1] += count(now.l1_accesses, since_.l1_accesses) * rates_.l1_access_j;
  ledger[Part::interconnect] += count(now.far_words, since_.far_words) * rates_.far_word_j;
  ledger[Part::dma] += rates_.dma_active_w * count(now.dma_cycles, since_.dma_cycles) * per_cluster_cycle_s +
                       rates_.dma_background_w * cluster_s;
  ledger[Part::fc_background] += rates_.fc_background_w * awake_s;
  ledger[Part::cluster_background] += rates_.cluster_background_w * cluster_s;
  ledger[Part::leakage] += rates_.leakage_w * awake_s + rates_.cluster_leakage_w * cluster_s;
  ledger[Part::retention] += rates_.retention_w * seconds(now.retained, since_.retained);
  return ledger;
}

double EnergyMeter::core_j(unsigned number, const CoreActivity& now) const {
  MEBOTS_ASSERT(number < inventory_.cluster_cores);
  MEBOTS_ASSERT(state_.cluster_clock_hz > 0);
  const auto& before = since_.of_cores[number];
  return settled_of_cores_j_[number] +
         count(now.instruction_fj, before.instruction_fj) * rates_.instruction * kFemtojoule +
         count(now.l1_accesses, before.l1_accesses) * rates_.l1_access_j +
         count(now.far_accesses, before.far_accesses) * (rates_.memory_access_j + rates_.far_word_j) -
         count(now.cycles, before.cycles) * rates_.core_gated_w / state_.cluster_clock_hz;
}

CountEnergy EnergyMeter::per_count_of_fabric_controller(bool cluster_on) const {
  auto power_w = rates_.fc_background_w + rates_.leakage_w;
  if (cluster_on) {
    power_w += rates_.core_gated_w * inventory_.cluster_cores + rates_.dma_background_w + rates_.cluster_background_w +
               rates_.cluster_leakage_w;
  }
  return {power_w / state_.clock_hz, rates_.instruction * kFemtojoule, rates_.memory_access_j, rates_.memory_access_j,
          rates_.memory_access_j};
}

CountEnergy EnergyMeter::per_count_of_core() const {
  MEBOTS_ASSERT(state_.cluster_clock_hz > 0);
  return {-rates_.core_gated_w / state_.cluster_clock_hz, rates_.instruction * kFemtojoule, rates_.l1_access_j,
          rates_.memory_access_j + rates_.far_word_j, 0};
}

void EnergyMeter::change(const PowerState& state, const Activity& now) {
  for (unsigned core = 0; core < inventory_.cluster_cores; ++core) {
    settled_of_cores_j_[core] = core_j(core, now.of_cores[core]);
  }
  settled_ = at(now);
  since_ = now;
  state_ = state;
  rates_ = rates_at(state);
}

void EnergyMeter::visit(state::Visitor& v) {
  v("state", state_);
  v("since", since_);
  v("settled", settled_);
  v("settled_of_cores_j", settled_of_cores_j_);
  if (v.restores()) rates_ = rates_at(state_);
}

}  // namespace mebots::soc
