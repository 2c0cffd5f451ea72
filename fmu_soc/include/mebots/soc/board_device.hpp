// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

/// An entry under "devices" of a board description, as its reader hands it to the device that it describes.
namespace mebots::soc {

struct BoardRegister {
  std::string name;
  std::uint32_t offset = 0;
  std::string access;  // r, w or rw
  std::string text;
  std::string shows;        // of a described device: "status" or one of its variables; empty = what was stored
  std::string sends;        // of a described device: the variable that what is stored goes out as; empty = none
  double units_per_si = 1;  // of the variable that it shows or sends
};

/// A value that means something when it is stored into a register: the device goes into a state.
struct BoardOpcode {
  std::string name;
  std::string register_name;
  std::uint32_t value = 0;
  std::string state;
  std::string text;
};

/// A variable of the surroundings that a described device senses.
struct BoardVariable {
  std::string name;
  double start = 0;
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

struct BoardDevice {
  std::string name;
  std::string text;
  std::uint32_t base = 0;
  int interrupt = -1;  // bit of mip, -1 = none
  double supply_voltage_v = 0;
  std::vector<BoardRegister> registers;  // by offset
  std::vector<BoardState> states;
  std::vector<BoardEnumeration> enumerations;
  /// Not empty: the device is described wholly by its entry, and begins in this state.
  std::string initial_state;
  std::vector<BoardOpcode> opcodes;
  std::vector<BoardVariable> sensed;  // its Real variables with causality input
  std::vector<std::string> sent;      // those with causality output; a described device's registers send them, but for
                                      // its power and energy

  std::string power_variable() const { return name + ".power"; }
  std::string energy_variable() const { return name + ".energy"; }

  /// Bytes that the registers take.
  std::uint32_t size() const { return registers.empty() ? 0 : registers.back().offset + 4; }
  /// Throws Error when the device has no such state.
  const BoardState& state(const std::string& state_name) const;
};

}  // namespace mebots::soc
