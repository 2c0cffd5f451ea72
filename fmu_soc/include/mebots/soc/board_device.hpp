// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/error.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Data structures for the entries of the list "devices" in a board file.
namespace mebots::soc {

struct BoardRegister {
  std::string name;
  std::uint32_t offset = 0;
  std::string access;       // r, w or rw
  std::uint32_t reset = 0;  // word after reset; only used for a described device
  std::string text;
  std::string shows;        // what a load returns: "status", a variable or a chip parameter; empty = the stored word
  std::string sends;        // variable that a store into a described device sets; empty = none
  double units_per_si = 1;  // register word = value in SI units * units_per_si
  bool commits = false;     // if true, a store into this register changes all outputs of the device at the same time
  /// Smallest value that a store to the register may contain, as a signed number; empty = no limit.
  std::optional<std::int32_t> least;
  std::optional<std::int32_t> most;
};

/// Describes a state change: if the firmware stores `value` into the register, the device enters `state`.
struct BoardOpcode {
  std::string name;
  std::string register_name;
  std::uint32_t value = 0;
  std::string state;
  std::string text;
};

/// Describes a variable that the device adds to the FMU.
struct BoardVariable {
  enum class Causality : std::uint8_t { parameter, input, output };

  std::string name;
  Causality causality = Causality::input;
  std::string type = "Real";  // FMI type Real, Integer, Boolean, String or Binary, or the name of an enumeration
  double start = 0;           // start value of a number; false is 0 and true is 1

  bool is_number() const { return type != "String" && type != "Binary"; }
  bool is_input() const { return causality != Causality::output; }
  [[deprecated("use is_input()")]] bool goes_in() const { return is_input(); }
};

struct BoardState {
  std::string name;
  double current_a = 0;
  double delay_s = 0;
  std::string text;
  std::string then;  // state that the device enters after the delay; empty = no change
};

struct BoardValue {
  std::string name;
  std::int32_t value = 0;
};

/// Names the values that a register can contain.
struct BoardEnumeration {
  std::string name;
  std::vector<BoardValue> items;  // sorted by value
};

/// Describes a part of the board that has no address: a memory at a serial bus, a camera, or the pads of the chip.
struct BoardPart {
  std::string attached_to;     // connection point DEVICE.PLACE through which the part transfers bytes; empty = none
  double charge_per_byte = 0;  // [C] for each transferred byte, in addition to the current of the part's state
};

/// Describes a voltage regulator and the parts that it supplies.
struct BoardRegulator {
  std::vector<std::string> loads;  // names of parts and other regulators, or kChipLoad
  double efficiency = 1;           // output power divided by input power
};
/// The name of the chip in BoardRegulator::loads.
inline constexpr std::string_view kChipLoad = "chip";

struct BoardDevice {
  std::string name;
  std::string kind = "described";  // name of the model that implements the device; see mebots/soc/device_kind.hpp
  std::string text;
  std::uint32_t base = 0;
  std::vector<std::uint32_t> also_at;  // further addresses at which the same registers appear
  /// Size of the address range [bytes], if it is larger than the registers; 0 = end of the last register.
  std::uint32_t span = 0;
  int interrupt = -1;                // bit of mip, or source number at the interrupt controller; -1 = none
  std::string interrupt_controller;  // device that receives the interrupt; empty = the core itself
  double supply_voltage_v = 0;
  std::vector<BoardRegister> registers;  // sorted by offset
  std::vector<BoardState> states;
  std::vector<BoardEnumeration> enumerations;
  std::string initial_state;
  std::vector<BoardOpcode> opcodes;
  std::vector<BoardVariable> variables;     // in the order of the board file
  std::optional<BoardPart> part;            // only set for a part of the board
  std::optional<BoardRegulator> regulator;  // only set for a voltage regulator

  bool is_on_bus() const { return !part && !regulator; }

  std::string power_variable() const { return name + ".power"; }
  std::string energy_variable() const { return name + ".energy"; }

  std::uint32_t size() const {
    const auto registers_end = registers.empty() ? 0 : registers.back().offset + 4;
    return std::max(span, registers_end);
  }
  /// Returns the state with this name. Throws Error if the device has no such state.
  const BoardState& state(std::string_view state_name) const {
    for (const auto& candidate : states) {
      if (candidate.name == state_name) return candidate;
    }
    throw Error("board: device " + name + " needs a state \"" + std::string(state_name) + "\" with its current");
  }
  /// Returns the variable with this name, or null if the device has no such variable.
  const BoardVariable* variable(std::string_view variable_name) const {
    const auto found = std::find_if(variables.begin(), variables.end(),
                                    [&](const BoardVariable& candidate) { return candidate.name == variable_name; });
    return found == variables.end() ? nullptr : &*found;
  }
};

}  // namespace mebots::soc
