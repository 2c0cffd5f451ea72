// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "isa/extension.hpp"
#include "mebots/soc/board_device.hpp"
#include "memory/instruction_cache.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Reader of board descriptions (configs/boards/*.json), for the simulation and for mebots-boardgen, which generates
/// headers and device skeletons from them.
namespace mebots::soc {

/// The location of a memory, which determines its latency.
enum class Place : std::uint8_t { fabric_controller, cluster };

/// Latency of a memory outside the cluster: wait cycles of an access for both directions.
struct BoardLatency {
  std::uint32_t fabric_controller = 0;  // for the fabric controller, in its clock
  std::uint32_t cluster = 0;            // for the cluster's cores and DMA: the part in the cluster's clock
  std::uint32_t soc = 0;                // the additional part in the clock of the SoC
};

struct BoardMemory {
  std::string name;
  std::uint32_t base = 0;
  std::uint32_t size = 0;  // bytes
  Place place = Place::fabric_controller;
  bool leaks = true;   // false: no real memory, so it has no leakage
  unsigned banks = 1;  // each serves a word per cycle; only modelled in the cluster
  bool arbitration_tree =
      false;  // of the cluster: an arbitration tree orders the cores at the banks; otherwise the order rotates
  std::uint32_t quantum = 64;           // of the cluster: ticks that a core runs before the next core
  std::optional<std::uint32_t> alias;   // a further address for the cores of its place
  std::optional<BoardLatency> latency;  // empty: the chip's latency for all memories
  std::string text;
};

/// Instruction caches by Place: one of the fabric controller, and one of the cluster's cores.
using BoardInstructionCaches = std::array<InstructionCacheSettings, 2>;

/// Supply of the chip. A chip without a supply entry always has power.
struct BoardSupply {
  std::string variable;  // a Real input of a device [V]; empty = none
  double least_v = 0;    // below this voltage, the chip switches off for good
};

/// An address range that the real machine uses and the board lacks. An access to the range is a fault, and the message
/// names the range.
struct BoardAbsence {
  std::string name;
  std::uint32_t base = 0;
  std::uint32_t size = 0;  // bytes
  std::string text;        // what to do without it
};

struct BoardDescription {
  std::string name;
  std::string text;
  std::string chip = "gap8";    // chip that provides clocks, latencies and energies
  std::string energy = "gap8";  // set of energies: params/<energy>.json
  std::string core;             // ri5cy, cv32e40p or an ISA string such as rv32imc; empty = the chip's core
  Extensions isa;               // options of the core
  unsigned pmp_entries = 0;     // of physical memory protection
  std::uint32_t hart_id = 0;    // mhartid of the fabric controller
  unsigned cluster_cores = 0;   // maximum; 0 = no cluster
  std::vector<BoardMemory> memories;
  BoardInstructionCaches instruction_caches;
  std::vector<BoardDevice> devices;
  std::vector<BoardAbsence> absent;
  BoardSupply supply;
  /// The device, or peripheral of a uDMA (spim0, spim1), that sends set-points. Sending them ends a decision about a
  /// picture. Empty if the board has no such device.
  std::string decisions_end_with;
  /// File names of the shared libraries that implement further kinds of devices. They are searched in `folder`, which
  /// contains the board file, and then in Settings::library_folders.
  std::vector<std::string> libraries;
  std::filesystem::path folder;  // folder of the file; empty for a board given as text

  const InstructionCacheSettings& instruction_cache(Place place) const {
    return instruction_caches[static_cast<std::size_t>(place)];
  }
};

/// Reads a board file. Throws Error with file, line and key of each mistake: unknown or repeated keys, invalid or
/// duplicate names, overlapping memories or devices, interrupts that the core does not have or that two devices share.
BoardDescription read_board(const std::filesystem::path& path);
/// Reads the text of a board file. `name` is its name in messages.
BoardDescription parse_board(std::string_view text, const std::string& name);

/// Sets the core by its name. The name of a generic core is an ISA string. Throws Error for a name that no core has.
void set_core(BoardDescription& board, const std::string& name);

/// Returns the chip for which a program of GreenWaves' SDKs was built. If the chip is GAP8 or unknown, the result is
/// empty. The function finds the chip in paths of the SDK's headers in the debug information. No other part of the file
/// states the chip: the file's note "Pulp_Info" reads chip=none, and the memory maps of the chips overlap.
std::string_view other_chip_of(std::string_view elf_bytes);

/// Throws Error if the board has GAP8's memory map and the program was built for another chip. Ignores a file that
/// cannot be read, because the loader of the program reports such a file.
void require_own_chip(const std::filesystem::path& program, const BoardDescription& board);

}  // namespace mebots::soc
