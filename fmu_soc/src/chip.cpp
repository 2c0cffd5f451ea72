// SPDX-License-Identifier: Apache-2.0
#include "chip.hpp"

#include "fmu_soc_board/chip_data.hpp"

#include "mebots/data_file.hpp"

#include <algorithm>
#include <cmath>

namespace mebots::soc {
namespace {

/// With it a block's 32-bit sum of femtojoules holds.
constexpr double kMostWeight = 100;

std::string_view class_of(Op op) {
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

/// Femtojoules of every operation at the reference point.
InstructionEnergy instruction_energy(const data::Node& weights, double reference_j) {
  weights.only({"alu", "multiply", "multiply_high", "divide", "load", "store", "branch", "jump", "system"});
  InstructionEnergy energy;
  for (int i = 0; i < kOpCount; ++i) {
    const auto op = static_cast<Op>(i);
    const auto weight = weights.number(class_of(op), data::Limits::between(0, kMostWeight));
    energy.fj[static_cast<std::size_t>(i)] =
        static_cast<std::uint32_t>(std::lround(weight * reference_j / kFemtojoule));
  }
  return energy;
}

std::uint32_t whole(const data::Node& node, std::string_view key, std::string_view unit, double least) {
  return static_cast<std::uint32_t>(std::lround(node.quantity(key, unit, data::Limits::between(least, 1e6))));
}

void read_interconnect(const data::Node& root, Chip& chip) {
  const auto ways = root.object("interconnect");
  ways.only({"fabric_controller_to_device", "fabric_controller_to_cluster", "cluster_to_soc", "dma_latency"});
  chip.interconnect.fabric_controller_to_device = whole(ways, "fabric_controller_to_device", "cycle", 0);
  chip.interconnect.fabric_controller_to_cluster = whole(ways, "fabric_controller_to_cluster", "cycle", 0);
  chip.interconnect.cluster_to_soc = whole(ways, "cluster_to_soc", "cycle", 0);
  chip.dma.latency = whole(ways, "dma_latency", "cycle", 0);
  const auto dma = root.object("dma");
  dma.only({"bytes_per_cycle", "burst", "outstanding"});
  chip.dma.bytes_per_cycle = whole(dma, "bytes_per_cycle", "byte/cycle", 1);
  chip.dma.most_burst_bytes = whole(dma, "burst", "byte", 1);
  const auto outstanding = whole(dma, "outstanding", "1", 1);
  chip.dma.least_burst_cycles = std::max(1U, (chip.dma.latency + outstanding - 1) / outstanding);
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
  nlohmann::json json;
  try {
    json = nlohmann::json::parse(json_text);
  } catch (const nlohmann::json::parse_error& error) {
    throw Error(fmt::format("{}: is not JSON: {}", name, error.what()));
  }
  const data::Node root(name, "", json);
  root.only({"name", "text", "core", "minimum_clock", "lowest_voltage", "highest_voltage", "clock_at_lowest_voltage",
             "clock_at_highest_voltage", "cluster_clock_at_lowest_voltage", "cluster_clock_at_highest_voltage",
             "voltage_step", "interconnect", "dma", "wake_up", "instruction_weight", "energy"});
  const auto positive = data::Limits::positive();
  Chip chip(root.object("energy"));
  const auto core = core_kind(root.text("core"));
  if (!core) root.fail("core", fmt::format("= \"{}\" must be ri5cy or cv32e40p", root.text("core")));
  chip.timing.kind = *core;
  chip.minimum_clock_hz = root.quantity("minimum_clock", "Hz", positive);
  chip.lowest_voltage_v = root.quantity("lowest_voltage", "V", positive);
  chip.highest_voltage_v = root.quantity("highest_voltage", "V", positive);
  if (chip.highest_voltage_v <= chip.lowest_voltage_v) root.fail("highest_voltage", "must be above lowest_voltage");
  chip.clock_at_lowest_voltage_hz = root.quantity("clock_at_lowest_voltage", "Hz", positive);
  chip.clock_at_highest_voltage_hz = root.quantity("clock_at_highest_voltage", "Hz", positive);
  chip.cluster_clock_at_lowest_voltage_hz = root.quantity("cluster_clock_at_lowest_voltage", "Hz", positive);
  chip.cluster_clock_at_highest_voltage_hz = root.quantity("cluster_clock_at_highest_voltage", "Hz", positive);
  chip.voltage_step_mv = static_cast<std::uint32_t>(std::lround(root.quantity("voltage_step", "V", positive) * 1000));
  read_interconnect(root, chip);
  chip.wake_up_s = root.quantity("wake_up", "s", data::Limits::between(0, 1));
  chip.instruction_energy = instruction_energy(root.object("instruction_weight"), chip.energy.reference_instruction_j);
  return chip;
}

const Chip& gap8() {
  static const Chip chip = parse_chip(kGap8Json, "gap8.json");
  return chip;
}

}  // namespace mebots::soc
