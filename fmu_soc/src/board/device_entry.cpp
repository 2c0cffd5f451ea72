// SPDX-License-Identifier: Apache-2.0
//
// Reads the devices of a board file: registers, states, variables, and the references between them.
#include "board/readers.hpp"

#include "board/settings.hpp"

#include "mebots/data/object.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

namespace mebots::soc {
namespace {

using data::Node;
using data::Object;

/// Highest source number of a PLIC. Source 0 does not exist. Source: RISC-V Platform-Level Interrupt Controller
/// Specification 1.0.0.
constexpr std::int64_t kMostSources = 1023;

/// Reads an interrupt number. With an interrupt controller, the number is a source of the controller. Otherwise it is
/// an interrupt line of RI5CY and CV32E40P: software, timer, external, or one of 16 fast lines.
int read_interrupt(const Node& node, bool has_controller) {
  if (has_controller) return static_cast<int>(node.whole_number(1, kMostSources));
  const auto line = static_cast<int>(node.whole_number(0, 31));
  if (line != 3 && line != 7 && line != 11 && line < 16) {
    node.fail(ErrorCode::value_out_of_range,
              fmt::format("the core has no interrupt {}; it has 3, 7, 11 and 16 to 31", line));
  }
  return line;
}

/// Reads a register's value, such as "0x5F5" or 1525.
std::uint32_t read_word(const Node& node) {
  if (!node.is(data::Kind::text)) {
    return static_cast<std::uint32_t>(node.whole_number(0, std::numeric_limits<std::uint32_t>::max()));
  }
  return read_number(node, "value");
}

std::int32_t read_signed_word(const Node& node) {
  return static_cast<std::int32_t>(
      node.whole_number(std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max()));
}

BoardRegister read_register(const Node& node, std::set<std::string>& names) {
  const auto access = data::word_of<std::string>({{"r", "r"}, {"w", "w"}, {"rw", "rw"}});
  Object object(node);
  BoardRegister entry;
  object.read("name", entry.name, new_name(names));
  object.read("offset", entry.offset, &read_address);
  object.read("access", entry.access, access);
  object.read_if("reset", entry.reset, &read_word);
  object.read_if("text", entry.text, &Node::text);
  object.read_if("shows", entry.shows, &Node::text);
  object.read_if("sends", entry.sends, &Node::text);
  object.read_if("units_per_si", entry.units_per_si, data::number(data::Limits::positive()));
  object.read_if("commits", entry.commits, &Node::flag);
  object.read_if("min", entry.least, &read_signed_word);
  object.read_if("max", entry.most, &read_signed_word);
  object.finish();
  if (object.sound() && (entry.least || entry.most) && entry.sends.empty()) {
    node.complain(ErrorCode::invalid_value,
                  fmt::format("{} has limits, but only a register that sends a variable can have them", entry.name));
  }
  return entry;
}

std::vector<BoardRegister> read_registers(const Node& node) {
  std::vector<BoardRegister> registers;
  std::set<std::string> names;
  std::map<std::uint32_t, std::string> offsets;
  for (const auto& element : node.elements()) {
    element.attempt([&] {
      auto entry = read_register(element, names);
      const auto [taken, is_new] = offsets.emplace(entry.offset, entry.name);
      if (!is_new && element.has("offset")) {
        element.at("offset").complain(ErrorCode::duplicate_name, fmt::format("{} has this offset too", taken->second));
      }
      registers.push_back(std::move(entry));
    });
  }
  if (node.elements().empty()) {
    node.fail(ErrorCode::invalid_value, "the list is empty, so firmware could not use the device: add a register");
  }
  std::ranges::sort(registers, {}, &BoardRegister::offset);
  return registers;
}

/// Returns a reader that reads each member of an object with `read`, and names the results by the keys.
template <typename T, typename Read>
auto by_name(Read read) {
  return [read](const Node& node) {
    std::vector<T> found;
    for (const auto& [key, member] : node.members()) {
      member.attempt([&, &key = key, &member = member] {
        checked_name(member, key);
        found.push_back(read(key, member));
      });
    }
    // Sorts by name, so that the result does not depend on the order in the file.
    std::ranges::stable_sort(found, {}, &T::name);
    return found;
  };
}

BoardState read_state(const std::string& name, const Node& node) {
  Object object(node);
  BoardState state;
  state.name = name;
  object.read("current", state.current_a, data::number(data::Limits::at_least(0)));
  object.read_if("delay", state.delay_s, data::number(data::Limits::between(0, 3600)));
  object.read_if("then", state.then, &Node::text);
  object.read_if("text", state.text, &Node::text);
  object.finish();
  return state;
}

BoardOpcode read_opcode(const std::string& name, const Node& node) {
  Object object(node);
  BoardOpcode opcode;
  opcode.name = name;
  object.read("register", opcode.register_name, &Node::text);
  object.read("value", opcode.value, count_up_to(std::numeric_limits<std::uint32_t>::max()));
  object.read("state", opcode.state, &Node::text);
  object.read_if("text", opcode.text, &Node::text);
  object.finish();
  return opcode;
}

BoardEnumeration read_enumeration(const std::string& name, const Node& node) {
  BoardEnumeration enumeration{name, {}};
  for (const auto& [item, member] : node.members()) {
    member.attempt([&, &item = item, &member = member] {
      enumeration.items.push_back({checked_name(member, item), read_signed_word(member)});
    });
  }
  std::ranges::sort(enumeration.items, {}, [](const BoardValue& item) { return std::tie(item.value, item.name); });
  return enumeration;
}

/// Minimum delay of a state. With shorter delays, a cycle of states could keep the simulation at one time.
constexpr double kLeastDelayS = 1e-6;

/// Follows the keys from `node` as far as they exist, and returns the last node found. Used for error messages.
Node nearest(const Node& node, std::initializer_list<std::string_view> keys) {
  Node found = node;
  for (const auto key : keys) {
    const auto member = found.find(key);
    if (!member) break;
    found = *member;
  }
  return found;
}

/// Returns the node of a register in the board file, for error messages.
Node entry_of(const Node& device, const BoardRegister& reg) {
  const auto entries = device.at("registers").elements();
  const auto found =
      std::ranges::find_if(entries, [&](const Node& entry) { return entry.at("name").text() == reg.name; });
  return found == entries.end() ? device : *found;
}

/// Returns the names of a device's numeric inputs, which registers may show, or outputs, which registers may send.
std::vector<std::string> numbers_of(const BoardDevice& device, bool inputs) {
  std::vector<std::string> names;
  for (const auto& variable : device.variables) {
    if (variable.is_input() == inputs && variable.is_number()) names.push_back(variable.name);
  }
  return names;
}

/// Checks a register with the key `sends`. The key must name an output of the device, and a store into the register
/// must have no other effect.
void check_sender(const Node& node, const BoardDevice& device, const BoardRegister& reg) {
  const auto entry = entry_of(node, reg);
  if (reg.access == "r" || !reg.shows.empty()) {
    entry.complain(ErrorCode::invalid_value,
                   fmt::format("{} sends a variable: it must be writable, and must not show a variable", reg.name));
  }
  const auto known = numbers_of(device, false);
  if (std::ranges::find(known, reg.sends) == known.end()) {
    nearest(entry, {"sends"}).complain_unknown("the device's output", reg.sends, known);
  }
  if (std::ranges::find(device.opcodes, reg.name, &BoardOpcode::register_name) != device.opcodes.end()) {
    entry.complain(ErrorCode::invalid_value, fmt::format("{} sends a variable: it must have no opcodes", reg.name));
  }
}

/// Checks a register with the key `shows`. The key must name an input or parameter of the device, or a parameter of the
/// chip.
void check_display(const Node& node, const BoardDevice& device, const BoardRegister& reg) {
  const auto entry = entry_of(node, reg);
  auto known = numbers_of(device, true);
  for (const auto& setting : kChipSettings) known.emplace_back(setting.variable);
  if (std::ranges::find(known, reg.shows) == known.end()) {
    known.insert(known.begin(), "status");
    nearest(entry, {"shows"}).complain_unknown("the device's input", reg.shows, known);
  }
  if (reg.access != "r") {
    entry.complain(ErrorCode::invalid_value,
                   fmt::format("register {} shows a variable, so its access must be \"r\"", reg.name));
  }
}

/// Checks that exactly one register sends each output of a described device, except its power and energy.
void check_outputs(const Node& node, const BoardDevice& device) {
  for (const auto& variable : device.variables) {
    if (variable.is_input()) continue;
    const auto& name = variable.name;
    const auto senders = std::ranges::count(device.registers, name, &BoardRegister::sends);
    const bool is_own = name == device.power_variable() || name == device.energy_variable();
    if (senders + (is_own ? 1 : 0) != 1) {
      node.at("variables")
          .complain(ErrorCode::invalid_value, fmt::format("{} must be sent by one register, or be {} or {}", name,
                                                          device.power_variable(), device.energy_variable()));
    }
  }
}

/// Checks a register with the key `commits`. Another register of the device must have the key `sends`, and a store into
/// the register that commits must have no other effect.
void check_commit(const Node& node, const BoardDevice& device, const BoardRegister& reg) {
  const auto entry = entry_of(node, reg);
  const bool takes_opcodes =
      std::ranges::find(device.opcodes, reg.name, &BoardOpcode::register_name) != device.opcodes.end();
  if (reg.access != "w" || !reg.shows.empty() || !reg.sends.empty() || takes_opcodes) {
    entry.complain(
        ErrorCode::invalid_value,
        fmt::format("{} has the key 'commits': its access must be w, and it must not have another effect", reg.name));
  }
  if (std::ranges::all_of(device.registers, [](const auto& other) { return other.sends.empty(); })) {
    entry.complain(ErrorCode::invalid_value, fmt::format("{} commits: no register of the device sends", reg.name));
  }
}

void require_state(const Node& node, const BoardDevice& device, const std::string& name) {
  if (std::ranges::find(device.states, name, &BoardState::name) != device.states.end()) return;
  std::vector<std::string> known;
  for (const auto& state : device.states) known.push_back(state.name);
  node.complain_unknown("the device's state", name, known);
}

void check_opcodes(const Node& node, const BoardDevice& device) {
  std::vector<std::string> writable;
  for (const auto& reg : device.registers) {
    if (reg.access != "r") writable.push_back(reg.name);
  }
  for (const auto& opcode : device.opcodes) {
    require_state(nearest(node, {"opcodes", opcode.name, "state"}), device, opcode.state);
    if (std::ranges::find(writable, opcode.register_name) != writable.end()) continue;
    nearest(node, {"opcodes", opcode.name, "register"})
        .complain_unknown("the writable register", opcode.register_name, writable);
  }
}

void check_names(const Node& node, const BoardDevice& device) {
  check_opcodes(node, device);
  for (const auto& state : device.states) {
    if (!state.then.empty()) require_state(nearest(node, {"states", state.name, "then"}), device, state.then);
  }
  for (const auto& reg : device.registers) {
    if (!reg.sends.empty()) check_sender(node, device, reg);
    if (reg.commits) check_commit(node, device, reg);
    if (!reg.shows.empty() && reg.shows != "status") check_display(node, device, reg);
  }
}

/// Checks the states and outputs of a device that has no C++ code.
void check_description(const Node& node, const BoardDevice& device) {
  if (device.initial_state.empty()) {
    if (!device.states.empty()) {
      node.complain(ErrorCode::missing_key,
                    "the key 'initial_state' is missing: a described device with states begins in one");
    }
  } else {
    require_state(node.at("initial_state"), device, device.initial_state);
  }
  for (const auto& state : device.states) {
    const auto entry = nearest(node, {"states", state.name});
    if (state.delay_s > 0 && state.delay_s < kLeastDelayS) {
      nearest(entry, {"delay"})
          .complain(ErrorCode::value_out_of_range,
                    fmt::format("{} s must be 0 or at least {} s", state.delay_s, kLeastDelayS));
    }
    if (state.delay_s > 0 && state.then.empty()) {
      entry.complain(ErrorCode::invalid_value, "the key 'then' is missing: the state has a delay");
    }
  }
  check_outputs(node, device);
}

/// Reads the start value of a number. modeldesc checks all other properties of variables.
double start_of(const Node& node) {
  if (!node.has("start")) return 0;
  const auto start = node.at("start");
  if (start.is(data::Kind::boolean)) return start.flag() ? 1 : 0;
  return start.number();
}

BoardVariable read_variable(const Node& node, bool described) {
  const auto causality = data::word_of<BoardVariable::Causality>({{"parameter", BoardVariable::Causality::parameter},
                                                                  {"input", BoardVariable::Causality::input},
                                                                  {"output", BoardVariable::Causality::output}});
  BoardVariable variable;
  variable.name = node.at("name").text();
  variable.causality = causality(node.at("causality"));
  if (node.has("type")) variable.type = node.at("type").text();
  if (!variable.is_number()) {
    if (described) {
      node.at("type").fail(ErrorCode::invalid_value,
                           fmt::format("a described device has numbers only, no {}; give it a kind", variable.type));
    }
  } else if (variable.name.find('{') != std::string::npos) {
    node.at("name").fail(ErrorCode::invalid_value, "a device's variables are named one by one, without groups");
  } else {
    variable.start = start_of(node);
  }
  return variable;
}

constexpr std::string_view kDescribed = "described";

BoardPart read_part(const Node& node) {
  Object object(node);
  BoardPart part;
  object.read_if("attached_to", part.attached_to, &Node::readable_text);
  object.read_if("charge_per_byte", part.charge_per_byte, data::number(data::Limits::at_least(0)));
  object.comment("text");
  object.finish();
  if (object.has("charge_per_byte") && part.attached_to.empty()) {
    node.complain(ErrorCode::missing_key,
                  "the key 'attached_to' is missing: it names the device whose bytes are counted");
  }
  return part;
}

BoardRegulator read_regulator(const Node& node) {
  Object object(node);
  BoardRegulator regulator;
  if (object.read("loads", regulator.loads, data::list_of(&Node::readable_text)) && regulator.loads.empty()) {
    node.at("loads").complain(ErrorCode::invalid_value, "the list is empty: a regulator has a load");
  }
  object.read_if("efficiency", regulator.efficiency, data::number(data::Limits::between(0.01, 1)));
  object.comment("text");
  object.finish();
  return regulator;
}

std::string_view kind_without_address(const Object& object) {
  return object.has("part") ? "part" : "regulator";
}

/// Checks a part of the board, which must not have keys for accesses by a program.
void check_part(const Node& node, const Object& object, const BoardDevice& device) {
  for (const auto* key :
       {"base", "also_at", "span", "interrupt", "interrupt_controller", "registers", "opcodes", "enumerations"}) {
    if (!object.has(key)) continue;
    node.at(key).complain(
        ErrorCode::invalid_value,
        fmt::format("{} is a part of the board, without an address: remove the key '{}'", device.name, key));
  }
  if (const auto kind = kind_without_address(object); device.kind != kind) {
    node.at("kind").complain(
        ErrorCode::invalid_value,
        fmt::format("{} has the key '{}', so its kind is \"{}\", not \"{}\": remove the key 'kind'", device.name, kind,
                    kind, device.kind));
  }
  if (device.part && device.regulator) {
    node.complain(ErrorCode::invalid_value, "a part of the board has 'part' or 'regulator', not both");
  }
  if (device.regulator && !device.states.empty()) {
    node.at("states").complain(ErrorCode::invalid_value, "a regulator has no states: remove the key 'states'");
  }
  if (device.part && !object.has("supply_voltage")) {
    node.complain(ErrorCode::missing_key, "the key 'supply_voltage' is missing: currents and charges need it");
  }
}

}  // namespace

BoardDevice read_device(const Node& node, std::set<std::string>& names) {
  Object object(node);
  BoardDevice device;
  object.read("name", device.name, new_name(names));
  object.read_if("kind", device.kind, &read_name);
  object.read_if("text", device.text, &Node::text);
  object.visit_if("part", [&](const Node& member) { device.part = read_part(member); });
  object.visit_if("regulator", [&](const Node& member) { device.regulator = read_regulator(member); });
  const bool on_bus = !object.has("part") && !object.has("regulator");
  if (!on_bus && !object.has("kind")) device.kind = kind_without_address(object);
  const bool described = device.kind == kDescribed;
  if (on_bus) {
    object.read("base", device.base, &read_address);
  } else {
    object.read_if("base", device.base, &read_address);
  }
  object.read_if("also_at", device.also_at, data::list_of(&read_address));
  object.read_if("span", device.span, &read_bytes);
  object.read_if("interrupt_controller", device.interrupt_controller, &Node::readable_text);
  object.read_if("interrupt", device.interrupt,
                 [&](const Node& member) { return read_interrupt(member, !device.interrupt_controller.empty()); });
  if (object.has("interrupt_controller") && !object.has("interrupt")) {
    node.complain(ErrorCode::missing_key,
                  "the key 'interrupt' is missing: it is the source of the interrupt controller");
  }
  object.read_if("supply_voltage", device.supply_voltage_v, data::number(data::Limits::positive()));
  if (on_bus && (described || !object.has("span"))) {
    object.read("registers", device.registers, &read_registers);
  } else {
    object.read_if("registers", device.registers, &read_registers);
  }
  object.read_if("states", device.states, by_name<BoardState>(&read_state));
  if (on_bus && !device.states.empty() && !object.has("supply_voltage")) {
    node.complain(ErrorCode::missing_key, "the key 'supply_voltage' is missing: the currents of the states need it");
  }
  object.read_if("opcodes", device.opcodes, by_name<BoardOpcode>(&read_opcode));
  object.read_if("initial_state", device.initial_state, &Node::readable_text);
  object.read_if("variables", device.variables,
                 data::list_of([&](const Node& member) { return read_variable(member, described); }));
  object.read_if("enumerations", device.enumerations, by_name<BoardEnumeration>(&read_enumeration));
  object.allow({"terminals"});  // only the FMU uses this key
  object.finish();
  if (!on_bus) check_part(node, object, device);
  if (!object.sound()) return device;
  check_names(node, device);
  if (described || !on_bus) check_description(node, device);
  return device;
}

}  // namespace mebots::soc
