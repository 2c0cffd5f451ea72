// SPDX-License-Identifier: Apache-2.0
#include "board_file.hpp"

#include "cluster/event_unit.hpp"
#include "memory/banks.hpp"

#include "mebots/data_file.hpp"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <set>

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
  if (value % 4 != 0) node.fail(key, fmt::format("= \"{}\" must be a multiple of 4", text));
  return static_cast<std::uint32_t>(value);
}

double whole_number(const data::Node& node, std::string_view key, const data::Limits& limits) {
  const auto value = node.number(key, limits);
  if (value != std::floor(value)) node.fail(key, fmt::format("= {} must be a whole number", value));
  return value;
}

unsigned whole(const data::Node& node, std::string_view key, unsigned most) {
  return static_cast<unsigned>(whole_number(node, key, data::Limits::between(0, most)));
}

std::string text_or_nothing(const data::Node& node) {
  return node.has("text") ? node.text("text") : std::string();
}

/// Names become names in C and C++.
std::string checked_name(const data::Node& node, std::string_view key, const std::string& name) {
  bool good = !name.empty() && std::isalpha(static_cast<unsigned char>(name[0])) != 0;
  for (const char c : name) good = good && (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_');
  if (!good) node.fail(key, fmt::format("= \"{}\" must be letters, digits and '_', a letter first", name));
  return name;
}

/// A name that no other of its list has.
std::string new_name(const data::Node& node, std::set<std::string>& taken) {
  auto name = checked_name(node, "name", node.text("name"));
  if (!taken.insert(name).second) node.fail("name", fmt::format("= \"{}\" is taken by another one", name));
  return name;
}

Place read_place(const data::Node& node) {
  const auto place = node.text("place");
  if (place != "fabric_controller" && place != "cluster") {
    node.fail("place", fmt::format("= \"{}\" must be fabric_controller or cluster", place));
  }
  return place == "cluster" ? Place::cluster : Place::fabric_controller;
}

BoardMemory read_memory(const data::Node& node, std::set<std::string>& names) {
  node.only({"name", "base", "size", "place", "banks", "leaks", "text"});
  BoardMemory memory;
  memory.name = new_name(node, names);
  memory.base = address(node, "base");
  memory.size = whole(node, "size", 1U << 30);
  if (memory.size == 0 || memory.size % 4 != 0) node.fail("size", "must be a multiple of 4 above 0");
  if (node.has("place")) memory.place = read_place(node);
  if (node.has("banks")) memory.banks = whole(node, "banks", Banks::kMost);
  if (!std::has_single_bit(memory.banks)) node.fail("banks", "must be a power of two");
  if (node.has("leaks")) memory.leaks = node.flag("leaks");
  memory.text = text_or_nothing(node);
  return memory;
}

constexpr std::uint32_t kMostCacheBytes = 1U << 20;
constexpr std::uint32_t kMostRefillCycles = 10'000;

void read_instruction_cache(const data::Node& node, BoardInstructionCaches& caches) {
  node.only({"place", "size", "line", "ways", "refill_cycles", "text"});
  auto& cache = caches[static_cast<std::size_t>(read_place(node))];
  if (cache.size != 0) node.fail("place", "has an instruction cache already");
  const auto power_of_two = [&](std::string_view key, unsigned least, unsigned most) {
    const auto value = whole(node, key, most);
    if (value < least || !std::has_single_bit(value)) {
      node.fail(key, fmt::format("= {} must be a power of two from {} to {}", value, least, most));
    }
    return value;
  };
  cache.line = power_of_two("line", 4, 1024);
  cache.ways = power_of_two("ways", 1, 64);
  cache.size = power_of_two("size", cache.line * cache.ways, kMostCacheBytes);
  cache.refill_cycles = whole(node, "refill_cycles", kMostRefillCycles);
}

/// The lines of RI5CY and CV32E40P: software, timer, external, and 16 fast ones.
int read_interrupt(const data::Node& node) {
  const auto line = static_cast<int>(whole(node, "interrupt", 31));
  if (line != 3 && line != 7 && line != 11 && line < 16) {
    node.fail("interrupt", fmt::format("= {}: the core has no such line; it has 3, 7, 11 and 16 to 31", line));
  }
  return line;
}

std::vector<BoardRegister> read_registers(const data::Node& device) {
  std::vector<BoardRegister> registers;
  std::set<std::string> names;
  for (const auto& node : device.objects("registers")) {
    node.only({"name", "offset", "access", "text", "shows", "sends", "units_per_si"});
    BoardRegister entry;
    entry.name = new_name(node, names);
    entry.offset = address(node, "offset");
    entry.access = node.text("access");
    entry.text = text_or_nothing(node);
    if (node.has("shows")) entry.shows = node.text("shows");
    if (node.has("sends")) entry.sends = node.text("sends");
    if (node.has("units_per_si")) entry.units_per_si = node.number("units_per_si", data::Limits::positive());
    if (entry.access != "r" && entry.access != "w" && entry.access != "rw") {
      node.fail("access", fmt::format("= \"{}\" must be r, w or rw", entry.access));
    }
    for (const auto& other : registers) {
      if (other.offset == entry.offset) node.fail("offset", fmt::format("is that of {} too", other.name));
    }
    registers.push_back(entry);
  }
  if (registers.empty()) device.fail("registers", "is empty: nothing could be said to the device");
  std::sort(registers.begin(), registers.end(), [](const auto& a, const auto& b) { return a.offset < b.offset; });
  return registers;
}

std::vector<BoardState> read_states(const data::Node& states) {
  std::vector<BoardState> found;
  for (const auto& name : states.keys()) {
    const auto node = states.object(name);
    node.only({"current", "delay", "then", "text"});
    const auto delay_s = node.has("delay") ? node.number("delay", data::Limits::between(0, 3600)) : 0.0;
    found.push_back({checked_name(states, name, name), node.number("current", data::Limits::at_least(0)), delay_s,
                     text_or_nothing(node), node.has("then") ? node.text("then") : std::string()});
  }
  return found;
}

std::vector<BoardOpcode> read_opcodes(const data::Node& opcodes) {
  std::vector<BoardOpcode> found;
  for (const auto& name : opcodes.keys()) {
    const auto node = opcodes.object(name);
    node.only({"register", "value", "state", "text"});
    const auto value = whole_number(node, "value", data::Limits::between(0, 4294967295.0));
    found.push_back({checked_name(opcodes, name, name), node.text("register"), static_cast<std::uint32_t>(value),
                     node.text("state"), text_or_nothing(node)});
  }
  return found;
}

/// A described device that goes from delay to delay must leave time for something else.
constexpr double kLeastDelayS = 1e-6;

/// A register that sends has its output, and nothing else to do.
void check_sender(const data::Node& node, const BoardDevice& device, const BoardRegister& reg) {
  if (reg.access == "r" || !reg.shows.empty()) {
    node.fail("registers", fmt::format("{} sends a variable: it must be writable and show nothing", reg.name));
  }
  if (std::find(device.sent.begin(), device.sent.end(), reg.sends) == device.sent.end()) {
    node.fail("registers",
              fmt::format("{} sends \"{}\", which is no output among the device's variables", reg.name, reg.sends));
  }
  if (std::any_of(device.opcodes.begin(), device.opcodes.end(),
                  [&](const auto& opcode) { return opcode.register_name == reg.name; })) {
    node.fail("registers", fmt::format("{} sends a variable: it must take no opcodes", reg.name));
  }
}

/// A register that shows a variable has its input.
void check_display(const data::Node& node, const BoardDevice& device, const BoardRegister& reg) {
  const bool sensed =
      std::any_of(device.sensed.begin(), device.sensed.end(), [&](const auto& v) { return v.name == reg.shows; });
  if (!sensed) {
    node.fail("registers",
              fmt::format("{} shows \"{}\", which is no input among the device's variables", reg.name, reg.shows));
  }
  if (reg.access != "r") node.fail("registers", fmt::format("{} shows a variable: its access must be r", reg.name));
}

/// Every output of a described device has one source.
void check_outputs(const data::Node& node, const BoardDevice& device) {
  for (const auto& name : device.sent) {
    const auto senders =
        std::count_if(device.registers.begin(), device.registers.end(), [&](const auto& r) { return r.sends == name; });
    const bool is_own = name == device.power_variable() || name == device.energy_variable();
    if (senders + (is_own ? 1 : 0) != 1) {
      node.fail("variables", fmt::format("{} must be sent by one register, or be {} or {}", name,
                                         device.power_variable(), device.energy_variable()));
    }
  }
}

void require_state(const data::Node& node, const BoardDevice& device, const std::string& key, const std::string& name) {
  const bool known =
      std::any_of(device.states.begin(), device.states.end(), [&](const auto& s) { return s.name == name; });
  if (!known) node.fail(key, fmt::format("names state \"{}\", which the device does not have", name));
}

void check_opcodes(const data::Node& node, const BoardDevice& device) {
  for (const auto& opcode : device.opcodes) {
    require_state(node, device, "opcodes." + opcode.name + ".state", opcode.state);
    const bool writable = std::any_of(device.registers.begin(), device.registers.end(),
                                      [&](const auto& r) { return r.name == opcode.register_name && r.access != "r"; });
    if (!writable) {
      node.fail("opcodes." + opcode.name + ".register",
                fmt::format("= \"{}\" is no register that can be written", opcode.register_name));
    }
  }
}

/// What names something must find it, in a described device as in one whose C++ begins as a skeleton.
void check_names(const data::Node& node, const BoardDevice& device) {
  check_opcodes(node, device);
  for (const auto& state : device.states) {
    if (!state.then.empty()) require_state(node, device, "states." + state.name + ".then", state.then);
  }
  for (const auto& reg : device.registers) {
    if (!reg.sends.empty()) check_sender(node, device, reg);
    if (!reg.shows.empty() && reg.shows != "status") check_display(node, device, reg);
  }
}

/// What a device needs that has no C++.
void check_description(const data::Node& node, const BoardDevice& device) {
  require_state(node, device, "initial_state", device.initial_state);
  for (const auto& state : device.states) {
    if (state.delay_s > 0 && state.delay_s < kLeastDelayS) {
      node.fail("states." + state.name + ".delay",
                fmt::format("= {} s must be 0 or at least {} s", state.delay_s, kLeastDelayS));
    }
    if (state.delay_s > 0 && state.then.empty())
      node.fail("states." + state.name + ".then", "is missing: the state has a delay");
  }
  check_outputs(node, device);
}

/// Real inputs and outputs. A described device has no other variables.
void read_variables(const data::Node& entry, BoardDevice& device) {
  const bool described = !device.initial_state.empty();
  for (const auto& node : entry.objects("variables")) {
    const auto causality = node.text("causality");
    if (node.has("type") && node.text("type") != "Real") {
      if (described) node.fail("type", "must be Real in a device with an initial_state");
    } else if (causality == "input") {
      device.sensed.push_back({node.text("name"), node.number("start")});
    } else if (causality == "output") {
      device.sent.push_back(node.text("name"));
    } else if (described) {
      node.fail("causality",
                fmt::format("= \"{}\" must be input or output in a device with an initial_state", causality));
    }
  }
}

std::vector<BoardEnumeration> read_enumerations(const data::Node& enumerations) {
  std::vector<BoardEnumeration> found;
  for (const auto& name : enumerations.keys()) {
    const auto node = enumerations.object(name);
    BoardEnumeration enumeration{checked_name(enumerations, name, name), {}};
    for (const auto& item : node.keys()) {
      const auto value = whole_number(node, item, data::Limits::between(-2147483648.0, 2147483647.0));
      enumeration.items.push_back({checked_name(node, item, item), static_cast<std::int32_t>(value)});
    }
    std::stable_sort(enumeration.items.begin(), enumeration.items.end(),
                     [](const auto& a, const auto& b) { return a.value < b.value; });
    found.push_back(enumeration);
  }
  return found;
}

BoardDevice read_device(const data::Node& node, std::set<std::string>& names) {
  node.only({"name", "base", "interrupt", "text", "supply_voltage", "states", "registers", "enumerations", "variables",
             "initial_state", "opcodes"});
  BoardDevice device;
  device.name = new_name(node, names);
  device.text = text_or_nothing(node);
  device.base = address(node, "base");
  if (node.has("interrupt")) device.interrupt = read_interrupt(node);
  if (node.has("supply_voltage")) device.supply_voltage_v = node.number("supply_voltage", data::Limits::positive());
  device.registers = read_registers(node);
  if (node.has("states")) device.states = read_states(node.object("states"));
  if (!device.states.empty() && device.supply_voltage_v == 0) {
    node.fail("supply_voltage", "is missing: the currents of the states need it");
  }
  if (node.has("opcodes")) device.opcodes = read_opcodes(node.object("opcodes"));
  if (node.has("initial_state")) {
    device.initial_state = node.text("initial_state");
    if (device.initial_state.empty()) node.fail("initial_state", "is empty");
  }
  if (node.has("variables")) read_variables(node, device);
  check_names(node, device);
  if (!device.initial_state.empty()) check_description(node, device);
  if (node.has("enumerations")) device.enumerations = read_enumerations(node.object("enumerations"));
  return device;
}

/// A piece of the address space.
struct Span {
  std::string name;
  std::uint64_t base;
  std::uint64_t size;
};

void check_overlaps(const data::Node& root, const BoardDescription& board) {
  std::vector<Span> taken;
  const auto take = [&](const std::string& key, const Span& span) {
    if (span.base + span.size > 0x1'0000'0000ULL) root.fail(key, "passes the end of the 32-bit address space");
    for (const auto& other : taken) {
      if (span.base < other.base + other.size && other.base < span.base + span.size) {
        root.fail(key, fmt::format("({}, 0x{:08x} to 0x{:08x}) overlaps {} at 0x{:08x}", span.name, span.base,
                                   span.base + span.size - 1, other.name, other.base));
      }
    }
    taken.push_back(span);
  };
  for (std::size_t i = 0; i < board.memories.size(); ++i) {
    const auto& memory = board.memories[i];
    take(fmt::format("memories[{}]", i), {memory.name, memory.base, memory.size});
  }
  for (std::size_t i = 0; i < board.devices.size(); ++i) {
    const auto& device = board.devices[i];
    take(fmt::format("devices[{}]", i), {device.name, device.base, device.size()});
  }
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
  root.only({"name", "text", "chip", "core", "cluster_cores", "memories", "instruction_caches", "devices"});
  BoardDescription board;
  board.name = checked_name(root, "name", root.text("name"));
  board.text = text_or_nothing(root);
  if (root.has("chip")) board.chip = root.text("chip");
  if (board.chip != "gap8") root.fail("chip", fmt::format("= \"{}\" is not known; known is gap8", board.chip));
  if (root.has("core")) board.core = root.text("core");
  if (!board.core.empty() && board.core != "ri5cy" && board.core != "cv32e40p") {
    root.fail("core", fmt::format("= \"{}\" must be ri5cy or cv32e40p", board.core));
  }
  if (root.has("cluster_cores")) board.cluster_cores = whole(root, "cluster_cores", kMostClusterCores);
  std::set<std::string> names;
  for (const auto& node : root.objects("memories")) board.memories.push_back(read_memory(node, names));
  if (board.memories.empty()) root.fail("memories", "is empty: a program needs RAM");
  if (root.has("instruction_caches")) {
    for (const auto& node : root.objects("instruction_caches")) read_instruction_cache(node, board.instruction_caches);
  }
  for (const auto& node : root.objects("devices")) board.devices.push_back(read_device(node, names));
  check_overlaps(root, board);
  return board;
}

}  // namespace mebots::soc
