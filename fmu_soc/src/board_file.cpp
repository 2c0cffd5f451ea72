// SPDX-License-Identifier: Apache-2.0
#include "board_file.hpp"

#include "mebots/data_file.hpp"

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
  const data::File file(path);
  const auto root = file.root();
  root.only({"name", "text", "memories", "devices"});
  BoardDescription board;
  board.name = root.text("name");
  for (const auto& node : root.objects("memories")) {
    node.only({"name", "base", "size", "text"});
    const auto size = node.number("size", data::Limits::between(4, 1U << 30));
    board.memories.push_back({node.text("name"), address(node, "base"), static_cast<std::uint32_t>(size)});
  }
  if (board.memories.empty()) root.fail("memories", "is empty: a program needs RAM");
  for (const auto& node : root.objects("devices")) board.devices.push_back(read_device(node));
  return board;
}

}  // namespace mebots::soc
