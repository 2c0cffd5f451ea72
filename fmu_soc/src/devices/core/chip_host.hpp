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

/// Services of the chip for the kinds of devices that come with MEbots, in addition to those of DeviceHost.
namespace mebots::soc {

namespace gap8_devices {
struct Signals;
}

/// The settings of the chip that the firmware can change.
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

/// The power supply and the clocks of the chip.
class PowerSource {
 public:
  virtual ~PowerSource() = default;
  virtual const Chip& chip() const = 0;
  virtual PowerSettings power_at_start() const = 0;
  virtual bool has_cluster() const = 0;
  /// Returns the present clock of the fabric controller.
  virtual double clock_hz() const = 0;
};

/// The parts of the board that are attached to devices, and the energy of loads.
class PartSource {
 public:
  virtual ~PartSource() = default;
  /// Returns the part that is attached to the device's connection point `place`. If no part is attached, returns an
  /// empty port.
  virtual PartPort part_at(const BoardDevice& entry, std::string_view place) = 0;
  /// Returns the names of the connection points for parts, as DEVICE.PLACE.
  virtual std::span<const std::string> places() const = 0;
  /// Returns the energy of the chip or of a device, by its name, up to a time [J].
  virtual double load_energy_j(std::string_view load, Picoseconds now) const = 0;
};

/// Pictures for a camera on a board without a world.
class PictureRoll {
 public:
  virtual ~PictureRoll() = default;
  /// True if there are pictures; the camera then ignores the world.
  virtual bool exists() const = 0;
  /// Returns a picture: grey pixels in rows of Himax::kWidth. Returns an empty span after the last picture.
  virtual std::span<const std::uint8_t> picture(std::size_t number) const = 0;
};

/// The files that the board starts with.
class ImageSource {
 public:
  virtual ~ImageSource() = default;
  /// Returns the initial content of the board's flash.
  virtual std::span<const std::uint8_t> flash() const = 0;
  virtual const PictureRoll& pictures() const = 0;
};

/// The devices of the chip that already exist.
class DeviceSource {
 public:
  virtual ~DeviceSource() = default;
  /// Returns the first device of this class; null if there is none.
  template <typename T>
  T* find() const {
    for (auto* device : made_devices()) {
      if (auto* found = dynamic_cast<T*>(device)) return found;
    }
    return nullptr;
  }
  /// Wires between GAP8's devices.
  virtual gap8_devices::Signals& signals() = 0;

 protected:
  virtual std::vector<Device*> made_devices() const = 0;
};

/// Byte-by-byte input and output of the console of a stand-alone program.
class ConsolePort {
 public:
  static constexpr int kNothingYet = -1;
  static constexpr int kEnded = -2;  // there will never be input again

  virtual ~ConsolePort() = default;
  /// Writes a byte. Returns false, without effect, if the console takes whole lines only (DeviceHost::print()).
  virtual bool write_console(std::uint8_t byte) = 0;
  /// Removes and returns the next byte of input. If there is no byte, returns kNothingYet, or kEnded after the end of
  /// the input.
  virtual int read_console(Picoseconds now) = 0;
};

/// Ends the program of the fabric controller.
class ProgramEnd {
 public:
  virtual ~ProgramEnd() = default;
  virtual void end_program(std::int32_t exit_code) = 0;
};

/// All services of the chip. The code of a kind passes to its device only the services that the device needs.
class ChipHost : public DeviceHost,
                 public PowerSource,
                 public PartSource,
                 public ImageSource,
                 public DeviceSource,
                 public ConsolePort,
                 public ProgramEnd {};

/// A device that collects the interrupts of other devices and has one line to the core. In the board file, the key
/// `interrupt` of this device names the line.
class InterruptController {
 public:
  virtual ~InterruptController() = default;
  /// Returns the highest number of a source; the lowest is 1.
  virtual unsigned last_source() const = 0;
  /// Sets the level of a source.
  virtual void set_source(unsigned source, bool level) = 0;
};

}  // namespace mebots::soc
