// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/timing.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// A board description (configs/boards/*.json) as the simulation reads it when it starts: memories, where the
/// devices stand, their interrupts and electrical states. Register offsets are compiled in, from the same file;
/// the one read at start must agree with them.
namespace mebots::soc {

/// Where a memory stands, which says how long the way to it is.
enum class Place : std::uint8_t { fabric_controller, cluster };

struct BoardMemory {
  std::string name;
  std::uint32_t base = 0;
  std::uint32_t size = 0;  // bytes
  Place place = Place::fabric_controller;
  unsigned banks = 1;  // that serve a word per cycle each; told apart in the cluster only
};

struct BoardRegister {
  std::string name;
  std::uint32_t offset = 0;
};

struct BoardState {
  std::string name;
  double current_a = 0;
  double delay_s = 0;
};

struct BoardDevice {
  std::string name;
  std::uint32_t base = 0;
  int interrupt = -1;  // bit of mip, -1 = none
  double supply_voltage_v = 0;
  std::vector<BoardRegister> registers;
  std::vector<BoardState> states;

  /// Throws Error when the device has no such state.
  const BoardState& state(const std::string& state_name) const;
};

struct BoardDescription {
  std::string name;
  std::optional<CoreKind> core;  // other than the chip's
  unsigned cluster_cores = 0;    // the most that there are; 0 = no cluster
  std::vector<BoardMemory> memories;
  std::vector<BoardDevice> devices;
};

/// Throws Error, naming file and key, for everything that does not fit.
BoardDescription read_board(const std::filesystem::path& path);
/// The same from the text of a board file; `name` stands in errors.
BoardDescription parse_board(std::string_view text, const std::string& name);

}  // namespace mebots::soc
