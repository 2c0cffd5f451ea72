// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "devices/core/described_device.hpp"
#include "devices/gap8/signals.hpp"
#include "mebots/soc/device_kind.hpp"
#include "mebots/soc/time.hpp"
#include "mebots/state/visitor.hpp"

#include <cmath>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>

namespace mebots::soc::gap8_devices {

struct UdmaTransfer {
  std::uint32_t address = 0;  // address in the chip's memory
  std::uint32_t size = 0;     // bytes
  std::uint32_t outside = 0;  // address on the HyperBus
  std::uint32_t channel = 0;
  Picoseconds done_at = 0;  // time of the end, for the first transfer in its queue; kNever = waits for its peripheral

  void visit(state::Visitor& v) {
    v("address", address);
    v("size", size);
    v("outside", outside);
    v("channel", channel);
    v("done_at", done_at);
  }
};

/// Models a peripheral that uses channels of the uDMA, together with the connected parts of the board. Register offsets
/// are relative to the uDMA's base address.
class UdmaPeripheral {
 public:
  UdmaPeripheral() = default;
  UdmaPeripheral(const UdmaPeripheral&) = delete;
  UdmaPeripheral& operator=(const UdmaPeripheral&) = delete;
  virtual ~UdmaPeripheral() = default;

  /// Returns the time at which a transfer that begins at `start` ends. Returns kNever if the transfer waits for an
  /// event; then the function is called again after that event.
  virtual Picoseconds end_time(const UdmaTransfer& transfer, Picoseconds start) = 0;
  /// Ends a transfer and copies its bytes.
  virtual void end(const UdmaTransfer& transfer) = 0;
  /// Cancels a transfer that has begun. Copies no bytes.
  virtual void cancel(const UdmaTransfer& /*transfer*/, Picoseconds /*now*/) {}

  /// Access registers that the board file does not describe. If no register has this offset, return false.
  virtual bool load(std::uint32_t /*offset*/, std::uint32_t& /*value*/) { return false; }
  virtual bool store(std::uint32_t /*offset*/, Picoseconds /*now*/, std::uint32_t /*value*/) { return false; }
  /// Called after a store into a register that the board file describes.
  virtual void registers_changed(std::uint32_t /*offset*/, Picoseconds /*now*/) {}

  /// Same meaning as the functions of Device (mebots/soc/device.hpp).
  virtual double* input(std::string_view /*variable*/) { return nullptr; }
  virtual std::string_view* text_input(std::string_view /*variable*/) { return nullptr; }
  virtual std::span<const std::uint8_t>* bytes_input(std::string_view /*variable*/) { return nullptr; }
  virtual const double* output(std::string_view /*variable*/) const { return nullptr; }
  virtual void begin_step(Picoseconds /*now*/) {}
  virtual bool takes_picture() const { return false; }
  virtual void program_ended() {}

  virtual void visit(state::Visitor& v) = 0;
};

/// Provides the services of the uDMA to its peripherals. Must outlive the peripherals.
struct UdmaHost {
  const BoardDevice& entry;
  DeviceHost& host;
  Signals& signals;
  std::function<double()> clock_hz;  // returns the clock frequency of the SoC
  DescribedDevice registers;         // registers that only store words

  std::uint32_t config(std::uint32_t offset) {
    std::uint32_t value = 0;
    registers.load(offset, 0, value);
    return value;
  }
  /// Returns the time that is `clocks` periods of the SoC's clock after `time`.
  Picoseconds later(Picoseconds time, double clocks) const {
    return time + std::llround(clocks / clock_hz() * kPsPerS);
  }
  /// Reports that a transfer has an address range outside memory.
  void complain_of_memory(std::uint32_t address, std::uint32_t size) const;
};

}  // namespace mebots::soc::gap8_devices
