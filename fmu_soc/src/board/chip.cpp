// SPDX-License-Identifier: Apache-2.0
#include "board/chip.hpp"

#include "fmu_soc_board/chip_data.hpp"

#include "mebots/assert.hpp"
#include "mebots/data/document.hpp"
#include "mebots/data/estimate.hpp"
#include "mebots/data/object.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::soc {
namespace {

/// Maximum energy of an instruction, relative to the reference instruction. With this maximum, the sum of the energies
/// of a block [fJ] fits in 32 bits.
constexpr double kMostWeight = 100;

/// Returns the class of instructions with the energy of this operation. GAP8's cores have no floating-point unit, so
/// that a floating-point operation has the energy of a similar integer operation.
std::string_view class_of(Op op) {
  const auto kind = traits_of(op).kind;
  if (kind == OpKind::float_multiply || kind == OpKind::float_multiply_add) return "multiply";
  if (kind == OpKind::float_divide || kind == OpKind::float_root) return "divide";
  if (op == Op::mul || is_multiply_accumulate(op) || is_dot_product(op)) return "multiply";
  if (is_multiply_high(op)) return "multiply_high";
  if (is_divide(op)) return "divide";
  if (is_load(op)) return "load";
  if (is_store(op)) return "store";
  if (is_branch(op)) return "branch";
  if (is_jump(op)) return "jump";
  if (is_csr(op) || op == Op::fence || op == Op::fence_i || op == Op::mret || op == Op::wfi) return "system";
  return "alu";
}

/// Reads the energy of every operation at the reference clock and voltage [fJ].
InstructionEnergy read_instruction_energy(const data::Node& node, double reference_j) {
  static constexpr std::array<std::string_view, 9> kClasses = {"alu",   "multiply", "multiply_high", "divide", "load",
                                                               "store", "branch",   "jump",          "system"};
  std::array<double, kClasses.size()> weights{};
  data::Object object(node);
  for (std::size_t i = 0; i < kClasses.size(); ++i) {
    object.read(kClasses[i], weights[i], data::number(data::Limits::between(0, kMostWeight)));
  }
  object.finish();
  InstructionEnergy energy;
  for (int i = 0; i < kOpCount; ++i) {
    const auto* const found = std::ranges::find(kClasses, class_of(static_cast<Op>(i)));
    const auto weight = weights[static_cast<std::size_t>(found - kClasses.begin())];
    energy.fj[static_cast<std::size_t>(i)] =
        static_cast<std::uint32_t>(std::lround(weight * reference_j / kFemtojoule));
  }
  return energy;
}

auto count(std::string_view unit, double least) {
  return [=](const data::Node& node) {
    return static_cast<std::uint32_t>(std::lround(data::read_quantity(node, unit, data::Limits::between(least, 1e6))));
  };
}

void read_interconnect(const data::Node& node, Chip& chip) {
  data::Object object(node);
  object.read("fabric_controller_to_device", chip.interconnect.fabric_controller_to_device, count("cycle", 0));
  object.read("fabric_controller_to_cluster", chip.interconnect.fabric_controller_to_cluster, count("cycle", 0));
  object.read("cluster_to_soc", chip.interconnect.cluster_to_soc, count("cycle", 0));
  object.read("dma_latency", chip.dma.latency, count("cycle", 0));
  object.finish();
}

void read_dma(const data::Node& node, Chip& chip) {
  data::Object object(node);
  object.read("bytes_per_cycle", chip.dma.bytes_per_cycle, count("byte/cycle", 1));
  object.read("burst", chip.dma.most_burst_bytes, count("byte", 1));
  object.read("outstanding", chip.dma.outstanding, count("1", 1));
  object.finish();
  chip.dma.least_burst_cycles = chip.dma.least_burst_of(chip.dma.latency);
}

void read_checks(const data::Node& node, EnergyChecks& checks) {
  data::Object object(node);
  object.read("least", checks.least, data::quantity("1", data::Limits::positive()));
  if (object.read("most", checks.most, data::quantity("1", data::Limits::positive())) && checks.most < checks.least) {
    node.at("most").complain(ErrorCode::invalid_value, "this must not be below least");
  }
  object.read("count", checks.count, count("1", 1));
  object.finish();
}

void read_energies(data::Object& object, Chip& chip) {
  object.visit("checks", [&](const data::Node& member) { read_checks(member, chip.checks); });
  object.read("energy", chip.energy, &EnergyTables::read);
  object.read("instruction_weight", chip.instruction_energy, [&](const data::Node& member) {
    return read_instruction_energy(member, chip.energy.reference_instruction_j);
  });
}

Chip read_chip(const data::Node& node) {
  const auto positive = data::Limits::positive();
  data::Object object(node);
  Chip chip;
  object.comment("$schema");
  object.comment("name");
  object.comment("text");
  object.read("core", chip.timing.kind, [](const data::Node& member) {
    const auto core = core_kind(member.text());
    if (!core) member.fail_unknown("the core", member.text(), std::vector<std::string>{"ri5cy", "cv32e40p", "rv32imc"});
    return *core;
  });
  const auto quantity = [&](std::string_view key, double& into, std::string_view unit) {
    return object.read(key, into, data::quantity(unit, positive));
  };
  quantity("minimum_clock", chip.minimum_clock_hz, "Hz");
  quantity("lowest_voltage", chip.lowest_voltage_v, "V");
  if (quantity("highest_voltage", chip.highest_voltage_v, "V") && chip.highest_voltage_v <= chip.lowest_voltage_v) {
    node.at("highest_voltage").complain(ErrorCode::invalid_value, "this must be above lowest_voltage");
  }
  quantity("clock_at_lowest_voltage", chip.clock_at_lowest_voltage_hz, "Hz");
  quantity("clock_at_highest_voltage", chip.clock_at_highest_voltage_hz, "Hz");
  quantity("cluster_clock_at_lowest_voltage", chip.cluster_clock_at_lowest_voltage_hz, "Hz");
  quantity("cluster_clock_at_highest_voltage", chip.cluster_clock_at_highest_voltage_hz, "Hz");
  object.read("voltage_step", chip.voltage_step_mv, [](const data::Node& member) {
    return static_cast<std::uint32_t>(
        std::lround(data::read_quantity(member, "V", data::Limits::between(0.001, 10)) * 1000));
  });
  object.visit("interconnect", [&](const data::Node& member) { read_interconnect(member, chip); });
  object.visit("dma", [&](const data::Node& member) { read_dma(member, chip); });
  object.read("wake_up", chip.wake_up_s, data::quantity("s", data::Limits::between(0, 1)));
  read_energies(object, chip);
  object.finish();
  return chip;
}

/// Returns a copy of `base` whose energies are replaced by those of `node`.
Chip read_energy_model(const data::Node& node, const Chip& base) {
  data::Object object(node);
  Chip chip = base;
  for (const auto* key : {"$schema", "name", "text"}) object.comment(key);
  read_energies(object, chip);
  object.finish();
  return chip;
}

}  // namespace

double Chip::highest_clock_hz(double voltage_v) const {
  const auto share = (voltage_v - lowest_voltage_v) / (highest_voltage_v - lowest_voltage_v);
  return clock_at_lowest_voltage_hz + share * (clock_at_highest_voltage_hz - clock_at_lowest_voltage_hz);
}

double Chip::highest_cluster_clock_hz(double voltage_v) const {
  const auto share = (voltage_v - lowest_voltage_v) / (highest_voltage_v - lowest_voltage_v);
  return cluster_clock_at_lowest_voltage_hz +
         share * (cluster_clock_at_highest_voltage_hz - cluster_clock_at_lowest_voltage_hz);
}

bool Chip::allows_voltage(std::uint32_t voltage_mv) const {
  const auto lowest_mv = static_cast<std::uint32_t>(std::lround(lowest_voltage_v * 1000));
  const auto highest_mv = static_cast<std::uint32_t>(std::lround(highest_voltage_v * 1000));
  return voltage_mv >= lowest_mv && voltage_mv <= highest_mv && (voltage_mv - lowest_mv) % voltage_step_mv == 0;
}

bool Chip::allows(std::uint32_t clock_hz, std::uint32_t voltage_mv) const {
  return allows_voltage(voltage_mv) && clock_hz >= minimum_clock_hz &&
         std::int64_t{clock_hz} <= std::llround(highest_clock_hz(voltage_mv / 1000.0));
}

bool Chip::allows_cluster(std::uint32_t clock_hz, std::uint32_t voltage_mv) const {
  return allows_voltage(voltage_mv) && clock_hz >= minimum_clock_hz &&
         std::int64_t{clock_hz} <= std::llround(highest_cluster_clock_hz(voltage_mv / 1000.0));
}

Chip parse_chip(const std::string& json_text, const std::string& name) {
  return data::Document(json_text, name).read(&read_chip);
}

const Chip& gap8() {
  static const Chip chip = parse_chip(kGap8Json, "gap8.json");
  return chip;
}

const Chip& gap8_silicon() {
  static const Chip silicon = data::Document(kGap8SiliconJson, "gap8_silicon.json").read([](const data::Node& node) {
    return read_energy_model(node, gap8());
  });
  return silicon;
}

namespace {

const Chip* chip_named(std::string_view energies) {
  if (energies == "gap8") return &gap8();
  return energies == "gap8_silicon" ? &gap8_silicon() : nullptr;
}

}  // namespace

const Chip& chip_of(const BoardDescription& board) {
  const auto* chip = chip_named(board.energy);
  MEBOTS_ASSERT(chip != nullptr, "the reader of boards knows no other");
  return *chip;
}

Chip calibrated_chip(const std::string& energies, double position) {
  const auto* named = chip_named(energies);
  if (named == nullptr)
    throw Error(fmt::format("energy.name = '{}' is unknown; there are gap8 and gap8_silicon", energies));
  auto chip = *named;
  std::vector<std::string> warnings;
  const data::Estimate factor{1, data::Estimate::Interval{chip.checks.least, chip.checks.most}};
  chip.energy.scale = data::Placement(energies, warnings).value(factor, position, "checks", "calibration.energy");
  return chip;
}

}  // namespace mebots::soc
