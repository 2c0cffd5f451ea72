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

/// Kinds of devices. An entry of a board file names a kind, and this kind creates the device.
///
/// You can write your own kinds in C++. Compile them into a shared library, and name this library in the board file:
///
///     class Wheels final : public mebots::soc::Device { ... };
///     std::unique_ptr<mebots::soc::Device> make(const mebots::soc::BoardDevice& entry, mebots::soc::DeviceHost& host);
///     MEBOTS_DEVICE_KINDS({"wheels", make})
///
///     "libraries": ["wheels.so"], "devices": [{"name": "left", "kind": "wheels", ...}]
///
/// The CMake function mebots_device_library() of the installed package builds the library. The command mebots-boardgen
/// --skeleton generates its source.
namespace mebots::soc {

/// Stores the times at which a picture was requested, the exposure of its first row began, its read-out began, and its
/// last pixel was stored in the chip's memory. Each time must be at or after the previous one.
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

/// Provides the chip's services to a device. A DeviceHost outlives the devices that use it.
class DeviceHost {
 public:
  DeviceHost() = default;
  DeviceHost(const DeviceHost&) = delete;
  DeviceHost& operator=(const DeviceHost&) = delete;
  virtual ~DeviceHost() = default;

  /// Reads or writes the chip's memories, for a device that transfers data without the core. If no memory contains all
  /// of the bytes, returns false and changes nothing.
  virtual bool read_memory(std::uint32_t address, std::span<std::uint8_t> bytes) const = 0;
  virtual bool write_memory(std::uint32_t address, std::span<const std::uint8_t> bytes) = 0;
  virtual bool is_memory(std::uint32_t address, std::uint32_t size) const = 0;

  /// Prints a line on the firmware's console.
  virtual void print(std::string_view line) = 0;
  /// Reports to the user that the firmware uses the device incorrectly.
  virtual void complain(std::string_view text) = 0;
  /// Returns the name of the function that the fabric controller executes, or an empty text if the function is unknown.
  /// Devices use the name in texts for complain().
  virtual std::string function() const { return {}; }

  /// Reports that a picture is in memory, which can begin a decision. Throws Error if the times are not in order.
  virtual void picture_stored(const PictureTimes& /*times*/) {}
  /// Reports that set-points were sent. If the key "decisions" of the board file names `sender`, a decision ends.
  virtual void setpoints_sent(std::string_view /*sender*/, Picoseconds /*now*/) {}
};

struct DeviceKind {
  std::string_view name;
  /// Creates a device. Throws Error if the entry is invalid. The entry outlives the device.
  std::unique_ptr<Device> (*make)(const BoardDevice& entry, DeviceHost& host);
};

/// Describes a shared library of device kinds. The chip refuses a library that was compiled with other headers.
struct DeviceLibrary {
  /// Version of the interface. Must be incremented whenever a header that such a library includes changes.
  static constexpr std::uint32_t kInterface = 6;

  std::uint32_t interface = kInterface;
  std::uint32_t entry_bytes = sizeof(BoardDevice);
  std::span<const DeviceKind> kinds;
};

}  // namespace mebots::soc

/// Defines the kinds of devices that a shared library implements, for example MEBOTS_DEVICE_KINDS({"left_wheel",
/// make_left}, {"right_wheel", make_right}). Must be used exactly once in the library, outside any namespace.
#define MEBOTS_DEVICE_KINDS(...)                                                                                \
  extern "C" __attribute__((visibility("default"))) const mebots::soc::DeviceLibrary* mebots_device_library() { \
    static const mebots::soc::DeviceKind kinds[] = {__VA_ARGS__};                                               \
    static const mebots::soc::DeviceLibrary library{.kinds = kinds};                                            \
    return &library;                                                                                            \
  }
