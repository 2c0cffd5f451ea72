// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board/board_file.hpp"
#include "devices/core/chip_host.hpp"
#include "devices/core/kind_library.hpp"
#include "fmu_soc_board/board.hpp"
#include "mebots/soc/device_kind.hpp"

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::soc {

/// Describes a kind of device that is part of MEbots. MEBOTS_CHIP_KIND defines a kind in the device's source file.
struct ChipKind {
  std::string_view name;
  /// Registers that an entry must list; empty = an entry may list any registers.
  std::span<const board::RegisterName> registers;
  /// Creates the device of an entry. Returns null if the device is part of the cluster.
  std::unique_ptr<Device> (*make)(const BoardDevice& entry, ChipHost& host);
};

template <typename T>
std::unique_ptr<Device> make_of_entry(const BoardDevice& entry, ChipHost& host) {
  return std::make_unique<T>(entry, host);
}

/// Kind of GAP8's event unit. If a board has this device, the fabric controller has GAP8's interrupts.
inline constexpr std::string_view kGap8EventUnitKind = "gap8_event_unit";
/// Kinds of the devices that the cluster creates itself. The board file defines only their addresses.
inline constexpr std::string_view kEventUnitKind = "event_unit";
inline constexpr std::string_view kClusterDmaKind = "cluster_dma";
inline constexpr std::string_view kGap8ClusterKind = "gap8_cluster";

/// Contains all kinds of devices that a board can name: those of MEbots and those of the board's libraries.
class Kinds {
 public:
  /// Opens the board's libraries, which are in the folder of the board file or in one of `folders`. Throws Error if a
  /// library is missing or was built for another version of MEbots, or if two kinds have the same name.
  Kinds(const BoardDescription& board, std::span<const std::filesystem::path> folders);

  /// Creates the device of an entry. Returns null if the device is part of the cluster. Throws Error if the kind is
  /// unknown, or if the registers of the entry differ from those of the kind.
  std::unique_ptr<Device> make(const BoardDevice& entry, ChipHost& host) const;

 private:
  std::vector<std::string> names() const;

  std::vector<KindLibrary> libraries_;
};

}  // namespace mebots::soc

/// Defines the kind NAME with its registers and the function that creates its device. Must be used at global scope, in
/// a file of devices/, where the build (fmu_soc/list_kinds.cmake) finds the kinds.
#define MEBOTS_CHIP_KIND(NAME, REGISTERS, ...)                                                      \
  namespace mebots::soc::kinds {                                                                    \
  extern const ChipKind kKind_##NAME;                                                               \
  const ChipKind kKind_##NAME{#NAME, std::span<const board::RegisterName>(REGISTERS), __VA_ARGS__}; \
  }
