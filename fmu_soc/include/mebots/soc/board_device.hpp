// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/error.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// An entry under "devices" of a board description, as its reader hands it to the device that it describes.
namespace mebots::soc {

struct BoardRegister {
  std::string name;
  std::uint32_t offset = 0;
  std::string access;       // r, w or rw
  std::uint32_t reset = 0;  // of a described device: what it holds after reset
  std::string text;
  std::string shows;        // of a described device: "status", a variable, a parameter of the chip; empty: its own
  std::string sends;        // of a described device: the variable that what is stored goes out as; empty = none
  double units_per_si = 1;  // of the variable that it shows or sends
  bool commits = false;     // a store sends what all other registers of the device hold, together
  std::optional<std::int32_t> least;  // that is sent, as a number with sign
  std::optional<std::int32_t> most;
};

/// A value that means something when it is stored into a register: the device goes into a state.
struct BoardOpcode {
  std::string name;
  std::string register_name;
  std::uint32_t value = 0;
  std::string state;
  std::string text;
};

/// A variable of the FMU that the device has to do with.
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
  std::string then;  // the state behind the delay; empty = it stays
};

struct BoardValue {
  std::string name;
  std::int32_t value = 0;
};

/// Names of values that a register takes.
struct BoardEnumeration {
  std::string name;
  std::vector<BoardValue> items;  // by value
};

/// What the board has beside the chip and without an address: a memory behind a bus, a camera, pads.
struct BoardPart {
  std::string attached_to;     // DEVICE.PLACE, where its traffic goes through; empty = it has none
  double charge_per_byte = 0;  // [C], beside the current of its state
};

/// What parts and the chip hang on, seen from its own input.
struct BoardRegulator {
  std::vector<std::string> loads;  // parts, other regulators, or kChipLoad
  double efficiency = 1;           // what comes out over what goes in
};
/// How a regulator names the chip.
inline constexpr std::string_view kChipLoad = "chip";

struct BoardDevice {
  std::string name;
  std::string kind = "described";  // which model: mebots/soc/device_kind.hpp
  std::string text;
  std::uint32_t base = 0;
  std::vector<std::uint32_t> also_at;  // further addresses of the same registers
  std::uint32_t span = 0;              // bytes of address space, where that is more than the registers take
  int interrupt = -1;                  // bit of mip, -1 = none
  double supply_voltage_v = 0;
  std::vector<BoardRegister> registers;  // by offset
  std::vector<BoardState> states;
  std::vector<BoardEnumeration> enumerations;
  std::string initial_state;
  std::vector<BoardOpcode> opcodes;
  std::vector<BoardVariable> variables;     // in the order of the file
  std::optional<BoardPart> part;            // a part of the board: it has no address
  std::optional<BoardRegulator> regulator;  // likewise

  bool is_on_bus() const { return !part && !regulator; }

  std::string power_variable() const { return name + ".power"; }
  std::string energy_variable() const { return name + ".energy"; }

  /// Bytes of the address space that are its own.
  std::uint32_t size() const {
    const auto registers_end = registers.empty() ? 0 : registers.back().offset + 4;
    return std::max(span, registers_end);
  }
  /// Throws Error when the device has no such state.
  const BoardState& state(std::string_view state_name) const {
    for (const auto& candidate : states) {
      if (candidate.name == state_name) return candidate;
    }
    throw Error("board: device " + name + " needs a state \"" + std::string(state_name) + "\" with its current");
  }
  /// Null when it has no such variable.
  const BoardVariable* variable(std::string_view variable_name) const {
    const auto found = std::find_if(variables.begin(), variables.end(),
                                    [&](const BoardVariable& candidate) { return candidate.name == variable_name; });
    return found == variables.end() ? nullptr : &*found;
  }
};

}  // namespace mebots::soc
