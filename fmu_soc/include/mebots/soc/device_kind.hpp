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

/// Times of a picture, in increasing order: request, start of exposure of the first row, start of read-out, last pixel
/// in the chip's memory.
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

/// Services of the chip for a device. Outlives the device.
class DeviceHost {
 public:
  DeviceHost() = default;
  DeviceHost(const DeviceHost&) = delete;
  DeviceHost& operator=(const DeviceHost&) = delete;
  virtual ~DeviceHost() = default;

  /// Read or write the chip's memories, for a device that accesses memory itself. If the bytes are not all in one
  /// memory, return false without effect.
  virtual bool read_memory(std::uint32_t address, std::span<std::uint8_t> bytes) const = 0;
  virtual bool write_memory(std::uint32_t address, std::span<const std::uint8_t> bytes) = 0;
  virtual bool is_memory(std::uint32_t address, std::uint32_t size) const = 0;

  /// Prints a line on the firmware's console.
  virtual void print(std::string_view line) = 0;
  /// Reports a wrong use of the device by the firmware. The text goes to the user.
  virtual void complain(std::string_view text) = 0;
  /// Returns the name of the function that the fabric controller executes, for texts of complain(). If the function is
  /// unknown, returns an empty text.
  virtual std::string function() const { return {}; }

  /// Reports that a picture is in memory, so that a decision may begin. Throws Error if the times are not in order.
  virtual void picture_stored(const PictureTimes& /*times*/) {}
  /// Reports that set-points were sent. This ends the time from picture to set-point if the board names this sender.
  virtual void setpoints_sent(std::string_view /*sender*/, Picoseconds /*now*/) {}
};

struct DeviceKind {
  std::string_view name;
  /// Creates a device. Throws Error if the entry is invalid. The entry outlives the device.
  std::unique_ptr<Device> (*make)(const BoardDevice& entry, DeviceHost& host);
};

/// Description of a shared library. A library built with other headers is refused.
struct DeviceLibrary {
  /// Must be incremented with every change of the headers that such a library includes.
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
