// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "memory/instruction_cache.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

/// A board description (configs/boards/*.json): the one reader of it, for the simulation that starts with it, and for
/// mebots-boardgen, which makes headers and device skeletons of it.
namespace mebots::soc {

/// Where a memory stands, which says how long the way to it is.
enum class Place : std::uint8_t { fabric_controller, cluster };

struct BoardMemory {
  std::string name;
  std::uint32_t base = 0;
  std::uint32_t size = 0;  // bytes
  Place place = Place::fabric_controller;
  bool leaks = true;   // false: stands for no real memory
  unsigned banks = 1;  // that serve a word per cycle each; told apart in the cluster only
  std::string text;
};

/// By Place: of the fabric controller, and what the cluster's cores share.
using BoardInstructionCaches = std::array<InstructionCacheSettings, 2>;

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

struct BoardDescription {
  std::string name;
  std::string text;
  std::string chip = "gap8";   // whose clocks, ways and energies
  std::string core;            // ri5cy or cv32e40p; empty = the chip's
  unsigned cluster_cores = 0;  // the most that there are; 0 = no cluster
  std::vector<BoardMemory> memories;
  BoardInstructionCaches instruction_caches;
  std::vector<BoardDevice> devices;

  const InstructionCacheSettings& instruction_cache(Place place) const {
    return instruction_caches[static_cast<std::size_t>(place)];
  }
};

/// Throws Error, naming file, line and key of everything that does not fit: unknown keys and keys that stand twice,
/// names that are none or are taken, memories and devices that overlap, interrupts that the core does not have.
BoardDescription read_board(const std::filesystem::path& path);
/// The same from the text of a board file; `name` stands in errors.
BoardDescription parse_board(std::string_view text, const std::string& name);

}  // namespace mebots::soc
