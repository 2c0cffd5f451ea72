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

/// Kinds of devices: an entry of a board file names a kind, which creates the device.
///
/// You can write your own kinds in C++, in a shared library that the board file names:
///
///     class Wheels final : public mebots::soc::Device { ... };
///     std::unique_ptr<mebots::soc::Device> make(const mebots::soc::BoardDevice& entry, mebots::soc::DeviceHost& host);
///     MEBOTS_DEVICE_KINDS({"wheels", make})
///
///     "libraries": ["wheels.so"], "devices": [{"name": "left", "kind": "wheels", ...}]
///
/// mebots_device_library() of the installed CMake package builds the library. mebots-boardgen --skeleton generates its
/// source.
namespace mebots::soc {

/// Stores the times at which a picture was requested, the exposure of its first row began, its read-out began, and its
/// last pixel was written into the chip's memory. The times must not decrease in this order.
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

/// Provides the services of the chip that a device may call. Outlives the device.
class DeviceHost {
 public:
  DeviceHost() = default;
  DeviceHost(const DeviceHost&) = delete;
  DeviceHost& operator=(const DeviceHost&) = delete;
  virtual ~DeviceHost() = default;

  /// Reads or writes the chip's memories, for a device that transfers data without the core. If the bytes are not all
  /// in one memory, returns false and changes nothing.
  virtual bool read_memory(std::uint32_t address, std::span<std::uint8_t> bytes) const = 0;
  virtual bool write_memory(std::uint32_t address, std::span<const std::uint8_t> bytes) = 0;
  virtual bool is_memory(std::uint32_t address, std::uint32_t size) const = 0;

  /// Prints a line on the firmware's console.
  virtual void print(std::string_view line) = 0;
  /// Reports to the user that the firmware uses the device wrongly.
  virtual void complain(std::string_view text) = 0;
  /// Returns the name of the function that the fabric controller executes, for the texts of complain(). If the function
  /// is unknown, returns an empty text.
  virtual std::string function() const { return {}; }

  /// Reports that a picture is in memory. This can begin a decision. Throws Error if the times are not in order.
  virtual void picture_stored(const PictureTimes& /*times*/) {}
  /// Reports that set-points were sent. If the board names this sender, this ends the time from picture to set-point.
  virtual void setpoints_sent(std::string_view /*sender*/, Picoseconds /*now*/) {}
};

struct DeviceKind {
  std::string_view name;
  /// Creates a device. Throws Error if the entry is invalid. The entry outlives the device.
  std::unique_ptr<Device> (*make)(const BoardDevice& entry, DeviceHost& host);
};

/// Describes a shared library. The simulation refuses a library that was built with other headers.
struct DeviceLibrary {
  /// Version of the interface. Must be incremented with every change of the headers that such a library includes.
  static constexpr std::uint32_t kInterface = 6;

  std::uint32_t interface = kInterface;
  std::uint32_t entry_bytes = sizeof(BoardDevice);
  std::span<const DeviceKind> kinds;
};

}  // namespace mebots::soc

/// Defines the kinds of a shared library: MEBOTS_DEVICE_KINDS({"left_wheel", make_left}, {"right_wheel", make_right}).
/// The macro must be used once per library, outside any namespace.
#define MEBOTS_DEVICE_KINDS(...)                                                                                \
  extern "C" __attribute__((visibility("default"))) const mebots::soc::DeviceLibrary* mebots_device_library() { \
    static const mebots::soc::DeviceKind kinds[] = {__VA_ARGS__};                                               \
    static const mebots::soc::DeviceLibrary library{.kinds = kinds};                                            \
    return &library;                                                                                            \
  }
