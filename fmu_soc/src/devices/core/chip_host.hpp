// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board/chip.hpp"
#include "devices/core/attached_part.hpp"
#include "mebots/soc/device_kind.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::soc {

namespace gap8_devices {
struct Signals;
}

struct PowerSettings {
  std::uint32_t clock_hz = 0;
  std::uint32_t cluster_clock_hz = 0;
  std::uint32_t voltage_mv = 0;
  std::uint32_t cluster_boot = 0;
  std::uint32_t cluster_on = 0;
  std::uint32_t retention = 0;  // if not 0, the next sleep is retention sleep

  void visit(state::Visitor& v) {
    v("clock_hz", clock_hz);
    v("cluster_clock_hz", cluster_clock_hz);
    v("voltage_mv", voltage_mv);
    v("cluster_boot", cluster_boot);
    v("cluster_on", cluster_on);
    v("retention", retention);
  }
};

class PowerSource {
 public:
  virtual ~PowerSource() = default;
  virtual const Chip& chip() const = 0;
  virtual PowerSettings power_at_start() const = 0;
  virtual bool has_cluster() const = 0;
  /// Returns the present clock frequency of the fabric controller.
  virtual double clock_hz() const = 0;
};

class PartSource {
 public:
  virtual ~PartSource() = default;
  /// Returns a port for the part that is attached to the device's connection point `place`. If no part is attached, the
  /// port is empty.
  virtual PartPort part_at(const BoardDevice& entry, std::string_view place) = 0;
  /// Returns the names of all points at which parts can be attached to the board's devices, in the form DEVICE.PLACE.
  virtual std::span<const std::string> places() const = 0;
  /// Returns the energy [J] that a load has used up to `now`. The load is the chip or a device, given by its name.
  virtual double load_energy_j(std::string_view load, Picoseconds now) const = 0;
};

/// Provides the pictures of a camera if the board is simulated without a world.
class PictureRoll {
 public:
  virtual ~PictureRoll() = default;
  /// Returns true if there are pictures. The camera then ignores the pictures of the world.
  virtual bool exists() const = 0;
  /// Returns the grey pixels of a picture in rows of Himax::kWidth. After the last picture, returns an empty span.
  virtual std::span<const std::uint8_t> picture(std::size_t number) const = 0;
};

class ImageSource {
 public:
  virtual ~ImageSource() = default;
  /// Returns the initial contents of the board's flash.
  virtual std::span<const std::uint8_t> flash() const = 0;
  virtual const PictureRoll& pictures() const = 0;
};

/// Lets a new device find those devices of the chip that were created before it.
class DeviceSource {
 public:
  virtual ~DeviceSource() = default;
  /// Returns the first device of class T. If no such device exists, returns null.
  template <typename T>
  T* find() const {
    for (auto* device : made_devices()) {
      if (auto* found = dynamic_cast<T*>(device)) return found;
    }
    return nullptr;
  }
  virtual gap8_devices::Signals& signals() = 0;

 protected:
  virtual std::vector<Device*> made_devices() const = 0;
};

/// Reads and writes a program's console byte by byte.
class ConsolePort {
 public:
  static constexpr int kNothingYet = -1;
  static constexpr int kEnded = -2;  // the input has ended; no byte will follow

  virtual ~ConsolePort() = default;
  /// Writes a byte. If the console accepts whole lines only (DeviceHost::print()), returns false without effect.
  virtual bool write_console(std::uint8_t byte) = 0;
  /// Removes and returns the next byte of input. Returns kNothingYet if no byte has arrived, and kEnded after the end
  /// of the input.
  virtual int read_console(Picoseconds now) = 0;
};

class ProgramEnd {
 public:
  virtual ~ProgramEnd() = default;
  virtual void end_program(std::int32_t exit_code) = 0;
};

/// Combines all services of the chip for MEbots' own devices. A device receives only those services that it needs.
class ChipHost : public DeviceHost,
                 public PowerSource,
                 public PartSource,
                 public ImageSource,
                 public DeviceSource,
                 public ConsolePort,
                 public ProgramEnd {};

/// Collects the interrupts of several devices into one line to the core. The key `interrupt` in the controller's entry
/// of the board file selects this line.
class InterruptController {
 public:
  virtual ~InterruptController() = default;
  /// Returns the highest source number. The lowest source number is 1.
  virtual unsigned last_source() const = 0;
  virtual void set_source(unsigned source, bool level) = 0;
};

}  // namespace mebots::soc
