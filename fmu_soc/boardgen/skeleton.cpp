// SPDX-License-Identifier: Apache-2.0
#include "headers.hpp"

#include "mebots/error.hpp"

#include <fmt/core.h>

#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::boardgen {
namespace {

using soc::BoardDevice;

std::string constant(const std::string& name) {
  return "k" + camel_case(name);
}

/// Returns the name of the data member for a register or a variable.
std::string member(const std::string& name) {
  return snake_case(name) + "_";
}

std::string state(const std::string& name) {
  return "State::" + snake_case(name);
}

/// Returns the variables that need a data member. Power and energy are computed from the device's states instead.
std::vector<soc::BoardVariable> kept(const BoardDevice& device) {
  std::vector<soc::BoardVariable> variables;
  for (const auto& variable : device.variables) {
    if (variable.name != device.power_variable() && variable.name != device.energy_variable()) {
      variables.push_back(variable);
    }
  }
  return variables;
}

std::string type_of(const soc::BoardVariable& variable) {
  if (variable.type == "String") return "std::string_view";
  return variable.is_number() ? "double" : "std::span<const std::uint8_t>";
}

std::string constants(const BoardDevice& device) {
  std::string out;
  for (const auto& reg : device.registers) {
    out += fmt::format("  static constexpr std::uint32_t {} = 0x{:X};  // {}: {}\n", constant(reg.name), reg.offset,
                       reg.access, reg.text);
  }
  for (const auto& opcode : device.opcodes) {
    out += fmt::format("  static constexpr std::uint32_t kOpcode{} = {};  // into {}: {}\n", camel_case(opcode.name),
                       opcode.value, opcode.register_name, opcode.text);
  }
  if (!device.states.empty()) {
    out += "  enum class State : std::uint8_t {\n";
    for (const auto& entry : device.states) out += fmt::format("    {},  // {}\n", snake_case(entry.name), entry.text);
    out += "  };\n";
  }
  return out;
}

/// Generates a function that returns data members by variable name, for the variables that `belongs` selects. If there
/// are no such variables, returns an empty text.
std::string finder(const BoardDevice& device, std::string_view head, std::string_view tail, auto belongs) {
  std::string rows;
  for (const auto& variable : kept(device)) {
    if (belongs(variable)) {
      rows += fmt::format("    if (variable == \"{}\") return &{};\n", variable.name, member(variable.name));
    }
  }
  if (rows.empty()) return {};
  return fmt::format("  {}(std::string_view variable) {} {{\n{}    return nullptr;\n  }}\n", head, tail, rows);
}

std::string variables(const BoardDevice& device) {
  const auto of = [](std::string_view type) {
    return [type](const soc::BoardVariable& variable) { return variable.is_input() && type_of(variable) == type; };
  };
  return finder(device, "double* input", "override", of("double")) +
         finder(device, "std::string_view* text_input", "override", of("std::string_view")) +
         finder(device, "std::span<const std::uint8_t>* bytes_input", "override", of("std::span<const std::uint8_t>")) +
         finder(device, "const double* output", "const override",
                [](const soc::BoardVariable& variable) { return !variable.is_input() && variable.is_number(); });
}

std::string energy(const BoardDevice& device) {
  if (device.states.empty()) return {};
  return "  double energy_j(Picoseconds now) const override {\n"
         "    double charge_as = 0;\n"
         "    for (std::size_t i = 0; i < spent_.size(); ++i) {\n"
         "      const auto time = spent_[i] + (i == static_cast<std::size_t>(state_) ? now - since_ : 0);\n"
         "      charge_as += entry_.states[i].current_a * static_cast<double>(time) / kPsPerS;\n"
         "    }\n"
         "    return charge_as * entry_.supply_voltage_v;\n  }\n";
}

std::string load(const BoardDevice& device) {
  std::string out =
      "  bool load(std::uint32_t offset, Picoseconds /*now*/, [[maybe_unused]] std::uint32_t& value) override {\n"
      "    switch (offset) {\n";
  for (const auto& reg : device.registers) {
    if (reg.access == "w") continue;
    out += fmt::format("      case {}:\n        value = {};\n        return true;\n", constant(reg.name),
                       member(reg.name));
  }
  return out + "      default:\n        return false;\n    }\n  }\n";
}

std::string store(const BoardDevice& device) {
  std::string out =
      "  bool store(std::uint32_t offset, [[maybe_unused]] Picoseconds now, [[maybe_unused]] std::uint32_t value) "
      "override {\n"
      "    switch (offset) {\n";
  for (const auto& reg : device.registers) {
    if (reg.access == "r") continue;
    out += fmt::format("      case {}:\n        {} = value;\n", constant(reg.name), member(reg.name));
    for (const auto& opcode : device.opcodes) {
      if (opcode.register_name != reg.name) continue;
      out += fmt::format("        if (value == kOpcode{}) enter({}, now);\n", camel_case(opcode.name),
                         state(opcode.state));
    }
    if (!reg.sends.empty()) {
      out += fmt::format("        {} = from_register(value, {});\n", member(reg.sends), reg.units_per_si);
    }
    out += "        return true;\n";
  }
  return out + "      default:\n        return false;\n    }\n  }\n";
}

std::string time(const BoardDevice& device) {
  if (device.states.empty()) return {};
  std::string out =
      "  void advance(Picoseconds now) override {\n"
      "    if (now < done_at_) return;\n"
      "    switch (state_) {\n";
  for (const auto& entry : device.states) {
    if (entry.then.empty()) continue;
    out += fmt::format("      case {}:  // its delay is over\n", state(entry.name));
    for (const auto& reg : device.registers) {
      if (reg.shows.empty() || reg.shows == "status") continue;
      out += fmt::format("        {} = to_register({}, {});\n", member(reg.name), member(reg.shows), reg.units_per_si);
    }
    out += fmt::format("        enter({}, done_at_);\n        break;\n", state(entry.then));
  }
  return out +
         "      default:\n        done_at_ = kNever;\n        break;\n    }\n  }\n"
         "  Picoseconds next_event() const override { return done_at_; }\n"
         "  std::string_view state_name() const override {\n"
         "    return entry_.states[static_cast<std::size_t>(state_)].name;\n  }\n";
}

std::vector<std::string> members_of(const BoardDevice& device) {
  std::vector<std::string> names;
  for (const auto& reg : device.registers) names.push_back(member(reg.name));
  for (const auto& variable : kept(device)) names.push_back(member(variable.name));
  if (!device.states.empty()) names.insert(names.end(), {"state_", "spent_", "since_", "done_at_"});
  return names;
}

/// Throws Error if two registers or variables need data members of the same name, or a name that every skeleton uses.
void require_different_members(const BoardDevice& device) {
  std::set<std::string> names{"entry_", "host_"};
  for (const auto& name : members_of(device)) {
    if (names.insert(name).second) continue;
    throw Error(fmt::format("device {}: the skeleton would have two members {}; rename the register or variable",
                            device.name, name));
  }
}

std::string saving(const BoardDevice& device) {
  std::set<std::string> passing;  // texts and bytes are not saved, because they are set again at each step
  for (const auto& variable : kept(device)) {
    if (!variable.is_number()) passing.insert(member(variable.name));
  }
  std::string out = "  void visit(state::Visitor& v) override {\n";
  for (const auto& name : members_of(device)) {
    if (passing.contains(name)) continue;
    out += fmt::format("    v(\"{}\", {});\n", std::string_view(name).substr(0, name.size() - 1), name);
  }
  return out + "  }\n";
}

std::string private_part(const BoardDevice& device) {
  std::string out = "\n private:\n";
  if (!device.states.empty()) {
    out +=
        "  void enter(State state, Picoseconds now) {\n"
        "    spent_[static_cast<std::size_t>(state_)] += now - since_;\n"
        "    since_ = now;\n"
        "    state_ = state;\n"
        "    const auto delay_s = entry_.states[static_cast<std::size_t>(state)].delay_s;\n"
        "    done_at_ = delay_s > 0 ? now + std::llround(delay_s * kPsPerS) : kNever;\n  }\n\n";
  }
  out += "  const BoardDevice& entry_;\n  [[maybe_unused]] DeviceHost& host_;\n";
  for (const auto& reg : device.registers) out += fmt::format("  std::uint32_t {} = 0;\n", member(reg.name));
  for (const auto& variable : kept(device)) {
    const auto start = variable.is_number() ? fmt::format(" = {}", variable.start) : "";
    out += fmt::format("  {} {}{};\n", type_of(variable), member(variable.name), start);
  }
  if (!device.states.empty()) {
    const auto first = device.initial_state.empty() ? device.states.front().name : device.initial_state;
    out += fmt::format("  State state_ = {};\n", state(first));
    out += fmt::format("  std::array<Picoseconds, {}> spent_{{}};  // in each state, up to the last change\n",
                       device.states.size());
    out += "  Picoseconds since_ = 0;\n  Picoseconds done_at_ = kNever;\n";
  }
  return out;
}

}  // namespace

std::string skeleton(const soc::BoardDescription& board, const BoardDevice& device) {
  require_different_members(device);
  const auto name = camel_case(device.name);
  const auto kind = device.kind == "described" ? device.name : device.kind;
  std::string out = fmt::format(
      "// SPDX-License-Identifier: Apache-2.0\n"
      "// Skeleton of the device \"{}\" of board \"{}\", written by mebots-boardgen. It stores values, executes "
      "opcodes and\n"
      "// counts their energy. Add everything else that the device does. As a shared library (mebots_device_library) "
      "that\n"
      "// the board names under \"libraries\", it is the device kind \"{}\".\n"
      "#include \"mebots/soc/device_kind.hpp\"\n#include \"mebots/soc/fixed_point.hpp\"\n\n"
      "#include <array>\n#include <cmath>\n#include <cstddef>\n#include <cstdint>\n#include <memory>\n#include <span>\n"
      "#include <string_view>\n\n"
      "namespace {{\n\nusing namespace mebots::soc;\nnamespace state = mebots::state;\n\n"
      "/// {}\n"
      "class {} final : public Device {{\n public:\n",
      device.name, board.name, kind, device.text, name);
  out += constants(device);
  out += fmt::format("\n  {}(const BoardDevice& entry, DeviceHost& host) : entry_(entry), host_(host) {{}}\n\n", name);
  out += variables(device) + energy(device) + "\n" + load(device) + store(device) + time(device) + saving(device);
  return out + private_part(device) +
         fmt::format(
             "}};\n\nstd::unique_ptr<Device> make(const BoardDevice& entry, DeviceHost& host) {{\n"
             "  return std::make_unique<{}>(entry, host);\n}}\n\n}}  // namespace\n\n"
             "MEBOTS_DEVICE_KINDS({{\"{}\", make}})\n",
             name, kind);
}

}  // namespace mebots::boardgen
