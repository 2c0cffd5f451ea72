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

/// A kind that comes with MEbots. MEBOTS_CHIP_KIND defines one next to its device.
struct ChipKind {
  std::string_view name;
  std::span<const board::RegisterName> registers;  // that an entry must have; empty = those of the entry
  /// Returns null for a kind that is part of the cluster.
  std::unique_ptr<Device> (*make)(const BoardDevice& entry, ChipHost& host);
};

/// Makes a device from its entry and the host alone.
template <typename T>
std::unique_ptr<Device> make_of_entry(const BoardDevice& entry, ChipHost& host) {
  return std::make_unique<T>(entry, host);
}

/// GAP8's, of the fabric controller: with it that has GAP8's interrupts.
inline constexpr std::string_view kGap8EventUnitKind = "gap8_event_unit";
/// Those that the cluster itself is made of: the board says where they are.
inline constexpr std::string_view kEventUnitKind = "event_unit";
inline constexpr std::string_view kClusterDmaKind = "cluster_dma";
inline constexpr std::string_view kGap8ClusterKind = "gap8_cluster";

/// The kinds that a board may name: those that come with MEbots, and those of its libraries.
class Kinds {
 public:
  /// Opens the board's libraries, which lie beside its file or in one of `folders`. Throws Error for one that is not
  /// there or not made for this MEbots, and for two kinds of one name.
  Kinds(const BoardDescription& board, std::span<const std::filesystem::path> folders);

  /// The device of an entry; null for one that is part of the cluster. Throws Error for a kind that there is not, and
  /// for registers that are not the kind's.
  std::unique_ptr<Device> make(const BoardDevice& entry, ChipHost& host) const;

 private:
  std::vector<std::string> names() const;

  std::vector<KindLibrary> libraries_;
};

}  // namespace mebots::soc

/// Defines the kind NAME: its registers and the function that makes its device, at global scope. The build finds the
/// kinds in the files of devices/ (fmu_soc/list_kinds.cmake), so that a new kind is one new file.
#define MEBOTS_CHIP_KIND(NAME, REGISTERS, ...)                                                      \
  namespace mebots::soc::kinds {                                                                    \
  extern const ChipKind kKind_##NAME;                                                               \
  const ChipKind kKind_##NAME{#NAME, std::span<const board::RegisterName>(REGISTERS), __VA_ARGS__}; \
  }
