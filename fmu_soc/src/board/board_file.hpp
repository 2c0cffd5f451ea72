// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/soc/board_device.hpp"
#include "memory/instruction_cache.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// A board description (configs/boards/*.json): the one reader of it, for the simulation that starts with it, and for
/// mebots-boardgen, which makes headers and device skeletons of it.
namespace mebots::soc {

/// Where a memory stands, which says how long the way to it is.
enum class Place : std::uint8_t { fabric_controller, cluster };

/// How long the way to a memory is that stands outside the cluster: cycles that an access waits there and back.
struct BoardLatency {
  std::uint32_t fabric_controller = 0;  // of the fabric controller, in its clock
  std::uint32_t cluster = 0;            // of the cluster's cores and DMA: as far as the cluster's clock goes
  std::uint32_t soc = 0;                // and behind that, in the clock of the SoC
};

struct BoardMemory {
  std::string name;
  std::uint32_t base = 0;
  std::uint32_t size = 0;  // bytes
  Place place = Place::fabric_controller;
  bool leaks = true;                    // false: stands for no real memory
  unsigned banks = 1;                   // that serve a word per cycle each; told apart in the cluster only
  bool arbitration_tree = false;        // of the cluster's: its cores' order at the banks is a tree's, else it rotates
  std::uint32_t quantum = 64;           // of the cluster's: ticks for which a core takes banks in one go
  std::optional<std::uint32_t> alias;   // where the cores of its place see it, too
  std::optional<BoardLatency> latency;  // nothing = as the chip has it for all memories
  std::string text;
};

/// By Place: of the fabric controller, and what the cluster's cores share.
using BoardInstructionCaches = std::array<InstructionCacheSettings, 2>;

/// What the chip lives on. Without one, nothing takes its power away.
struct BoardSupply {
  std::string variable;  // a Real input of a device [V]; empty = none
  double least_v = 0;    // below it the chip loses its power, and stays without
};

struct BoardDescription {
  std::string name;
  std::string text;
  std::string chip = "gap8";    // whose clocks, ways and energies
  std::string energy = "gap8";  // whose joules: params/<energy>.json
  std::string core;             // ri5cy, cv32e40p or rv32imc; empty = the chip's
  std::uint32_t hart_id = 0;    // what the fabric controller reads as mhartid
  unsigned cluster_cores = 0;   // the most that there are; 0 = no cluster
  std::vector<BoardMemory> memories;
  BoardInstructionCaches instruction_caches;
  std::vector<BoardDevice> devices;
  BoardSupply supply;
  /// What sends set-points, with which a decision about a picture ends: a device, or a peripheral of a uDMA (spim0,
  /// spim1); empty = nothing.
  std::string decisions_end_with;
  /// Shared libraries with kinds of devices, as the file names them: beside it, in `folder`, or where the program says.
  std::vector<std::string> libraries;
  std::filesystem::path folder;  // of the file; empty for one that was a text

  const InstructionCacheSettings& instruction_cache(Place place) const {
    return instruction_caches[static_cast<std::size_t>(place)];
  }
};

/// Throws Error, naming file, line and key of everything that does not fit. That is: unknown keys and keys that
/// stand twice, names that are none or are taken, memories and devices that overlap. Interrupts that the core does not
/// have or that two devices would share.
BoardDescription read_board(const std::filesystem::path& path);
/// The same from the text of a board file; `name` stands in errors.
BoardDescription parse_board(std::string_view text, const std::string& name);

/// Returns the chip that a program of GreenWaves' SDKs was built for if it is not GAP8; empty if it is not known. The
/// paths of the SDK's headers in the debug information show it: the file has it nowhere else (its note "Pulp_Info"
/// reads chip=none), and the chips' memory maps overlap.
std::string_view other_chip_of(std::string_view elf_bytes);

/// Throws Error if the board has GAP8's memory map and the program was built for another chip. A file that cannot be
/// read passes; its loader reports it.
void require_own_chip(const std::filesystem::path& program, const BoardDescription& board);

}  // namespace mebots::soc
