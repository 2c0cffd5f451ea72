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

/// Reads board descriptions (configs/boards/*.json). The simulation uses them, and mebots-boardgen generates headers
/// and device skeletons from them.
namespace mebots::soc {

/// Names the part of the chip that contains a memory. This part determines the latency of the memory.
enum class Place : std::uint8_t { fabric_controller, cluster };

/// Stores the wait cycles that an access to a memory outside the cluster takes, for request and reply together.
struct BoardLatency {
  std::uint32_t fabric_controller = 0;  // wait cycles for the fabric controller, counted in its clock
  std::uint32_t cluster = 0;            // wait cycles for the cluster's cores and DMA, counted in the cluster's clock
  std::uint32_t soc = 0;                // additional wait cycles for the cluster, counted in the clock of the SoC
};

struct BoardMemory {
  std::string name;
  std::uint32_t base = 0;
  std::uint32_t size = 0;  // bytes
  Place place = Place::fabric_controller;
  bool leaks = true;                   // false for a range that is no memory on silicon and has no leakage
  unsigned banks = 1;                  // each bank serves one word per cycle; only modelled for a memory of the cluster
  bool arbitration_tree = false;       // cluster only: a tree orders the cores at a bank; false: the order rotates
  std::uint32_t quantum = 64;          // only for the cluster: number of ticks that a core runs before the next core
  std::optional<std::uint32_t> alias;  // second address of the memory, for the cores in `place`
  /// Latency of this memory; empty = the latency that the chip has for all memories.
  std::optional<BoardLatency> latency;
  std::string text;
};

/// Stores the settings of the fabric controller's and of the cluster's instruction cache, indexed by Place.
using BoardInstructionCaches = std::array<InstructionCacheSettings, 2>;

/// Describes the power supply of the chip. A chip without a supply entry always has power.
struct BoardSupply {
  std::string variable;  // Real input of a device that contains the voltage [V]; empty = none
  double least_v = 0;    // if the voltage falls below this value, the chip switches off until the end of the run
};

/// Describes an address range that the real machine uses and the board lacks. An access to the range is a fault, and
/// the message names the range.
struct BoardAbsence {
  std::string name;
  std::uint32_t base = 0;
  std::uint32_t size = 0;  // bytes
  std::string text;        // advice to the user: how to run a program without the range
};

struct BoardDescription {
  std::string name;
  std::string text;
  std::string chip = "gap8";    // name of the chip that defines clocks, latencies and energies
  std::string energy = "gap8";  // name of the set of energies in params/<energy>.json
  std::string core;             // ri5cy, cv32e40p or an ISA string such as rv32imc; empty = the chip's core
  Extensions isa;               // instruction set extensions of the core
  unsigned pmp_entries = 0;     // number of entries of the physical memory protection
  std::uint32_t hart_id = 0;    // mhartid of the fabric controller
  unsigned cluster_cores = 0;   // highest number of cores in the cluster; 0 = no cluster
  std::vector<BoardMemory> memories;
  BoardInstructionCaches instruction_caches;
  std::vector<BoardDevice> devices;
  std::vector<BoardAbsence> absent;
  BoardSupply supply;
  /// Name of the device that sends set-points, or of a uDMA's peripheral (spim0, spim1). When it sends set-points, a
  /// decision about a picture ends. Empty if the board has no such device.
  std::string decisions_end_with;
  /// File names of the shared libraries that implement further kinds of devices. They are searched in `folder`, which
  /// contains the board file, and then in Settings::library_folders.
  std::vector<std::string> libraries;
  std::filesystem::path folder;  // folder that contains the board file; empty for a board that was given as text

  const InstructionCacheSettings& instruction_cache(Place place) const {
    return instruction_caches[static_cast<std::size_t>(place)];
  }
};

/// Reads a board file. Throws Error with file, line and key of each mistake: unknown or repeated keys, invalid or
/// duplicate names, overlapping memories or devices, interrupts that the core does not have or that two devices share.
BoardDescription read_board(const std::filesystem::path& path);
/// Reads the text of a board file. Error messages name the file `name`.
BoardDescription parse_board(std::string_view text, const std::string& name);

/// Sets the core by its name. The name of a generic core is an ISA string. Throws Error if no core has this name.
void set_core(BoardDescription& board, const std::string& name);

/// Returns the chip for which a program of GreenWaves' SDKs was built. If the chip is GAP8 or unknown, the result is
/// empty. The function finds the chip in paths of the SDK's headers in the debug information. No other part of the file
/// states the chip: the file's note "Pulp_Info" reads chip=none, and the memory maps of the chips overlap.
std::string_view other_chip_of(std::string_view elf_bytes);

/// Throws Error if the board has GAP8's memory map and the program was built for another chip. Ignores a file that
/// cannot be read, because the loader of the program reports such a file.
void require_own_chip(const std::filesystem::path& program, const BoardDescription& board);

}  // namespace mebots::soc
