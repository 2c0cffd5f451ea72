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

namespace mebots::soc {

/// Part of the chip that contains a memory.
enum class Place : std::uint8_t { fabric_controller, cluster };

/// Wait cycles of an access to a memory outside the cluster, for request and reply together.
struct BoardLatency {
  std::uint32_t fabric_controller = 0;  // cycles of the fabric controller's clock, for its accesses
  std::uint32_t cluster = 0;            // cycles of the cluster's clock, for accesses of its cores and DMA
  std::uint32_t soc = 0;                // additional cycles of the SoC's clock, for accesses of the cluster
};

struct BoardMemory {
  std::string name;
  std::uint32_t base = 0;
  std::uint32_t size = 0;  // bytes
  Place place = Place::fabric_controller;
  bool leaks = true;              // false for a range without leakage, because silicon has no memory there
  unsigned banks = 1;             // each bank serves one word per cycle; only for a memory of the cluster
  bool arbitration_tree = false;  // true: a tree orders cores at a bank; false: the order rotates; only for the cluster
  std::uint32_t quantum = 64;     // ticks that a core runs before the next core; only for the cluster
  std::optional<std::uint32_t> alias;  // second address of the memory, for the cores in `place`
  /// Latency of this memory; empty = the chip's latency.
  std::optional<BoardLatency> latency;
  std::string text;
};

/// Indexed by Place.
using BoardInstructionCaches = std::array<InstructionCacheSettings, 2>;

/// A chip without a supply entry always has power.
struct BoardSupply {
  std::string variable;  // name of the Real input with the voltage [V]; empty = no supply
  double least_v = 0;    // below this voltage, the chip switches off until the end of the run
};

/// An address range of the real machine that the board lacks. An access is a fault, whose message names the range.
struct BoardAbsence {
  std::string name;
  std::uint32_t base = 0;
  std::uint32_t size = 0;  // bytes
  std::string text;        // advice how to run a program without this range
};

struct BoardDescription {
  std::string name;
  std::string text;
  std::string chip = "gap8";    // name of the chip, which defines clocks, latencies and energies
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
  /// Name of the device, or of the uDMA's peripheral (spim0, spim1), that sends set-points. When it sends them, the
  /// program's decision about a picture ends: see Decisions. Empty if the board has no such device.
  std::string decisions_end_with;
  /// File names of shared libraries that implement further kinds of devices. They are searched in `folder` and in
  /// Settings::library_folders.
  std::vector<std::string> libraries;
  std::filesystem::path folder;  // folder of the board file; empty for a board that was given as text

  const InstructionCacheSettings& instruction_cache(Place place) const {
    return instruction_caches[static_cast<std::size_t>(place)];
  }
};

/// Reads a board file. Throws Error with file, line and key of each mistake: unknown or repeated keys, invalid or
/// duplicate names, overlapping memories or devices, interrupts that the core does not have or that two devices share.
BoardDescription read_board(const std::filesystem::path& path);
/// Reads the text of a board file. Error messages name the file `name`.
BoardDescription parse_board(std::string_view text, const std::string& name);

/// Sets the core by its name or ISA string. Throws Error if no core has this name.
void set_core(BoardDescription& board, const std::string& name);

/// Returns the chip for which a program of GreenWaves' SDKs was built, or an empty text if the chip is GAP8 or unknown.
/// The chip is found in paths of the SDK's headers in the debug information, because no other part of the file names
/// the chip.
std::string_view other_chip_of(std::string_view elf_bytes);

/// Throws Error if the board has GAP8's memory map and the program was built for another chip. Ignores a file that
/// cannot be read, because the program's loader reports it.
void require_own_chip(const std::filesystem::path& program, const BoardDescription& board);

}  // namespace mebots::soc
