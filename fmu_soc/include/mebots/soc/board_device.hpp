// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/error.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Entries under "devices" of a board description. The reader passes each entry to the device that the entry describes.
namespace mebots::soc {

struct BoardRegister {
  std::string name;
  std::uint32_t offset = 0;
  std::string access;       // r, w or rw
  std::uint32_t reset = 0;  // of a described device: value after reset
  std::string text;
  std::string
      shows;  // of a described device: "status", a variable, or a parameter of the chip; empty: the register's own word
  std::string sends;                  // of a described device: the variable that a store sets; empty = none
  double units_per_si = 1;            // scale of the variable that it shows or sends
  bool commits = false;               // a store sets all outputs that the device's registers send, at the same time
  std::optional<std::int32_t> least;  // least value that can be sent, as a signed number
  std::optional<std::int32_t> most;
};

/// An opcode: if the firmware stores this value into the register, the device changes to the state `state`.
struct BoardOpcode {
  std::string name;
  std::string register_name;
  std::uint32_t value = 0;
  std::string state;
  std::string text;
};

/// A variable of the FMU that the device uses.
struct BoardVariable {
  enum class Causality : std::uint8_t { parameter, input, output };

  std::string name;
  Causality causality = Causality::input;
  std::string type = "Real";  // Integer, Boolean, String, Binary, or the name of an enumeration
  double start = 0;           // of a number; false and true are 0 and 1

  bool is_number() const { return type != "String" && type != "Binary"; }
  /// True for inputs and parameters.
  bool is_input() const { return causality != Causality::output; }
  [[deprecated("use is_input()")]] bool goes_in() const { return is_input(); }
};

struct BoardState {
  std::string name;
  double current_a = 0;
  double delay_s = 0;
  std::string text;
  std::string then;  // next state after the delay; empty = none
};

struct BoardValue {
  std::string name;
  std::int32_t value = 0;
};

/// Names of the values of a register.
struct BoardEnumeration {
  std::string name;
  std::vector<BoardValue> items;  // by value
};

/// A part of the board outside the chip and without an address: a memory behind a bus, a camera, pads.
struct BoardPart {
  std::string attached_to;     // DEVICE.PLACE through which its traffic passes; empty = none
  double charge_per_byte = 0;  // [C], in addition to the current of its state
};

/// A voltage regulator, with the parts or the chip that it supplies.
struct BoardRegulator {
  std::vector<std::string> loads;  // parts, other regulators, or kChipLoad
  double efficiency = 1;           // output power over input power
};
/// Name of the chip as a load of a regulator.
inline constexpr std::string_view kChipLoad = "chip";

struct BoardDevice {
  std::string name;
  std::string kind = "described";  // model of the device: mebots/soc/device_kind.hpp
  std::string text;
  std::uint32_t base = 0;
  std::vector<std::uint32_t> also_at;  // further base addresses of the same registers
  std::uint32_t span = 0;              // bytes of address space, if more than the registers take
  int interrupt = -1;                  // bit of mip, or source of the interrupt controller; -1 = none
  std::string interrupt_controller;    // device that collects the interrupt; empty = the core itself
  double supply_voltage_v = 0;
  std::vector<BoardRegister> registers;  // by offset
  std::vector<BoardState> states;
  std::vector<BoardEnumeration> enumerations;
  std::string initial_state;
  std::vector<BoardOpcode> opcodes;
  std::vector<BoardVariable> variables;     // in the order of the file
  std::optional<BoardPart> part;            // set for a part of the board, which has no address
  std::optional<BoardRegulator> regulator;  // set for a regulator, which has no address

  bool is_on_bus() const { return !part && !regulator; }

  std::string power_variable() const { return name + ".power"; }
  std::string energy_variable() const { return name + ".energy"; }

  /// Returns the size of the device's address range in bytes.
  std::uint32_t size() const {
    const auto registers_end = registers.empty() ? 0 : registers.back().offset + 4;
    return std::max(span, registers_end);
  }
  /// Returns the state of this name. Throws Error if the device has none.
  const BoardState& state(std::string_view state_name) const {
    for (const auto& candidate : states) {
      if (candidate.name == state_name) return candidate;
    }
    throw Error("board: device " + name + " needs a state \"" + std::string(state_name) + "\" with its current");
  }
  /// Returns null if the device has no such variable.
  const BoardVariable* variable(std::string_view variable_name) const {
    const auto found = std::find_if(variables.begin(), variables.end(),
                                    [&](const BoardVariable& candidate) { return candidate.name == variable_name; });
    return found == variables.end() ? nullptr : &*found;
  }
};

}  // namespace mebots::soc
