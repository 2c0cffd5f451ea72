// SPDX-License-Identifier: Apache-2.0
#include "board_file.hpp"

#include "cluster/event_unit.hpp"
#include "memory/banks.hpp"

#include "mebots/data_file.hpp"

#include <bit>
#include <cmath>

namespace mebots::soc {
namespace {

std::uint32_t address(const data::Node& node, std::string_view key) {
  const auto text = node.text(key);
  std::size_t used = 0;
  unsigned long long value = 0;
  try {
    value = std::stoull(text, &used, 0);
  } catch (const std::exception&) {
    used = 0;
  }
  if (used == 0 || used != text.size() || value > 0xffffffffULL) {
    node.fail(key, fmt::format("= \"{}\" must be a 32-bit address such as \"0x1A102000\"", text));
  }
  return static_cast<std::uint32_t>(value);
}

unsigned whole(const data::Node& node, std::string_view key, unsigned most) {
  const auto value = node.number(key, data::Limits::between(0, most));
  if (value != std::floor(value)) node.fail(key, fmt::format("= {} must be a whole number", value));
  return static_cast<unsigned>(value);
}

BoardMemory read_memory(const data::Node& node) {
  node.only({"name", "base", "size", "place", "banks", "text"});
  BoardMemory memory;
  memory.name = node.text("name");
  memory.base = address(node, "base");
  memory.size = whole(node, "size", 1U << 30);
  const auto place = node.has("place") ? node.text("place") : "fabric_controller";
  if (place != "fabric_controller" && place != "cluster") {
    node.fail("place", fmt::format("= \"{}\" must be fabric_controller or cluster", place));
  }
  memory.place = place == "cluster" ? Place::cluster : Place::fabric_controller;
  if (node.has("banks")) memory.banks = whole(node, "banks", Banks::kMost);
  if (!std::has_single_bit(memory.banks)) node.fail("banks", "must be a power of two");
  return memory;
}

BoardDevice read_device(const data::Node& node) {
  node.only(
      {"name", "base", "interrupt", "text", "supply_voltage", "states", "registers", "enumerations", "variables"});
  BoardDevice device;
  device.name = node.text("name");
  device.base = address(node, "base");
  if (device.base % 4 != 0) node.fail("base", "must be a multiple of 4");
  if (node.has("interrupt"))
    device.interrupt = static_cast<int>(node.number("interrupt", data::Limits::between(0, 31)));
  if (node.has("supply_voltage")) device.supply_voltage_v = node.number("supply_voltage", data::Limits::positive());
  for (const auto& entry : node.objects("registers")) {
    entry.only({"name", "offset", "access", "text"});
    device.registers.push_back({entry.text("name"), address(entry, "offset")});
  }
  if (node.has("states")) {
    const auto states = node.object("states");
    for (const auto& name : states.keys()) {
      const auto entry = states.object(name);
      entry.only({"current", "delay", "text"});
      const auto delay_s = entry.has("delay") ? entry.number("delay", data::Limits::between(0, 3600)) : 0.0;
      device.states.push_back({name, entry.number("current", data::Limits::at_least(0)), delay_s});
    }
  }
  return device;
}

}  // namespace

const BoardState& BoardDevice::state(const std::string& state_name) const {
  for (const auto& candidate : states) {
    if (candidate.name == state_name) return candidate;
  }
  throw Error(fmt::format("board: device {} needs a state \"{}\" with its current", name, state_name));
}

BoardDescription read_board(const std::filesystem::path& path) {
  return parse_board(data::text_of(path), path.string());
}

BoardDescription parse_board(std::string_view text, const std::string& name) {
  const data::File file(text, name);
  const auto root = file.root();
  root.only({"name", "text", "core", "cluster_cores", "memories", "devices"});
  BoardDescription board;
  if (root.has("core")) {
    const auto core = core_kind(root.text("core"));
    if (!core) root.fail("core", fmt::format("= \"{}\" must be ri5cy or cv32e40p", root.text("core")));
    board.core = core;
  }
  if (root.has("cluster_cores")) board.cluster_cores = whole(root, "cluster_cores", kMostClusterCores);
  board.name = root.text("name");
  for (const auto& node : root.objects("memories")) {
    board.memories.push_back(read_memory(node));
  }
  if (board.memories.empty()) root.fail("memories", "is empty: a program needs RAM");
  for (const auto& node : root.objects("devices")) board.devices.push_back(read_device(node));
  return board;
}

}  // namespace mebots::soc
