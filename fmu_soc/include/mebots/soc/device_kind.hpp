// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/soc/board_device.hpp"
#include "mebots/soc/device.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

/// Kinds of devices: an entry of a board file names one, and the kind makes the device.
///
/// A kind of one's own is C++ in a shared library that the board file names:
///
///     class Wheels final : public mebots::soc::Device { ... };
///     std::unique_ptr<mebots::soc::Device> make(const mebots::soc::BoardDevice& entry, mebots::soc::DeviceHost& host);
///     MEBOTS_DEVICE_KINDS({"wheels", make})
///
///     "libraries": ["wheels.so"], "devices": [{"name": "left", "kind": "wheels", ...}]
///
/// mebots_device_library() of the installed CMake package builds it; mebots-boardgen --skeleton begins its source.
namespace mebots::soc {

/// When a camera was asked for a picture, when its first row began to gather light, when reading out began, and when
/// its last pixel was in the chip's memory: in this order.
struct PictureTimes {
  Picoseconds asked = 0;
  Picoseconds exposed = 0;
  Picoseconds read_out = 0;
  Picoseconds stored = 0;

  void visit(state::Visitor& v) {
    v("asked", asked);
    v("exposed", exposed);
    v("read_out", read_out);
    v("stored", stored);
  }
};

/// What the chip does for a device. Lives longer than the device.
class DeviceHost {
 public:
  DeviceHost() = default;
  DeviceHost(const DeviceHost&) = delete;
  DeviceHost& operator=(const DeviceHost&) = delete;
  virtual ~DeviceHost() = default;

  /// The chip's memories, as a device with an access of its own sees them. False, with nothing done, when not all of it
  /// lies in one memory.
  virtual bool read_memory(std::uint32_t address, std::span<std::uint8_t> bytes) const = 0;
  virtual bool write_memory(std::uint32_t address, std::span<const std::uint8_t> bytes) = 0;
  virtual bool is_memory(std::uint32_t address, std::uint32_t size) const = 0;

  /// A line of the firmware's console.
  virtual void print(std::string_view line) = 0;
  /// What whoever runs the firmware should know: it used the device wrongly.
  virtual void complain(std::string_view text) = 0;
  /// The function that the fabric controller executes, for such texts; empty = not known.
  virtual std::string function() const { return {}; }

  /// A picture is in memory now: a decision may begin. Throws Error for times out of their order.
  virtual void picture_stored(const PictureTimes& /*times*/) {}
  /// Set-points go out: a decision ends when this is the sender that the board names.
  virtual void setpoints_sent(std::string_view /*sender*/, Picoseconds /*now*/) {}
};

struct DeviceKind {
  std::string_view name;
  /// Throws Error for an entry that does not fit. The entry lives as long as the device.
  std::unique_ptr<Device> (*make)(const BoardDevice& entry, DeviceHost& host);
};

/// What a shared library says of itself; one that was built with other headers is refused.
struct DeviceLibrary {
  /// Goes up with every change of the headers that such a library includes.
  static constexpr std::uint32_t kInterface = 3;

  std::uint32_t interface = kInterface;
  std::uint32_t entry_bytes = sizeof(BoardDevice);
  std::span<const DeviceKind> kinds;
};

}  // namespace mebots::soc

/// The kinds of a shared library: MEBOTS_DEVICE_KINDS({"left_wheel", make_left}, {"right_wheel", make_right}). Once per
/// library, outside any namespace.
#define MEBOTS_DEVICE_KINDS(...)                                                                                \
  extern "C" __attribute__((visibility("default"))) const mebots::soc::DeviceLibrary* mebots_device_library() { \
    static const mebots::soc::DeviceKind kinds[] = {__VA_ARGS__};                                               \
    static const mebots::soc::DeviceLibrary library{.kinds = kinds};                                            \
    return &library;                                                                                            \
  }
