// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board_file.hpp"
#include "devices/attached_part.hpp"
#include "devices/kind_library.hpp"
#include "devices/power_manager.hpp"
#include "gap8_devices/signals.hpp"
#include "gap8_devices/udma_camera.hpp"
#include "mebots/soc/device_kind.hpp"

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::soc {

/// What the kinds that come with MEbots get beyond what any kind does.
class ChipHost : public DeviceHost {
 public:
  virtual const Chip& chip() const = 0;
  virtual PowerSettings power_at_start() const = 0;
  virtual bool has_cluster() const = 0;
  /// Of the fabric controller, now.
  virtual double clock_hz() const = 0;
  virtual gap8_devices::Signals& signals() = 0;
  /// What the board's flash holds at the start.
  virtual std::span<const std::uint8_t> flash() = 0;
  /// What the board's camera sees, where no world says it.
  virtual const gap8_devices::PictureRoll& pictures() const = 0;
  /// The part of the board that is attached to this place of the device, if there is one.
  virtual PartPort part_at(const BoardDevice& entry, std::string_view place) = 0;
  /// Where devices have let parts be attached, as DEVICE.PLACE.
  virtual std::span<const std::string> places() const = 0;
  /// Of the chip or a device, by its name, up to a time.
  virtual double load_energy_j(std::string_view load, Picoseconds now) const = 0;
  /// A device made before by its class; null = there is none.
  template <typename T>
  T* find() const {
    for (auto* device : devices()) {
      if (auto* found = dynamic_cast<T*>(device)) return found;
    }
    return nullptr;
  }

 protected:
  virtual std::vector<Device*> devices() const = 0;
};

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
