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

/// A transfer of a channel of the uDMA.
struct UdmaTransfer {
  std::uint32_t address = 0;  // in the chip's memory
  std::uint32_t size = 0;     // bytes
  std::uint32_t outside = 0;  // address on the HyperBus
  std::uint32_t channel = 0;  // index of the channel
  Picoseconds done_at = 0;    // of the first transfer of its queue; kNever = it waits for its peripheral

  void visit(state::Visitor& v) {
    v("address", address);
    v("size", size);
    v("outside", outside);
    v("channel", channel);
    v("done_at", done_at);
  }
};

/// A peripheral on channels of the uDMA, with its connected parts of the board. Offsets of registers are relative to
/// the uDMA's base address.
class UdmaPeripheral {
 public:
  UdmaPeripheral() = default;
  UdmaPeripheral(const UdmaPeripheral&) = delete;
  UdmaPeripheral& operator=(const UdmaPeripheral&) = delete;
  virtual ~UdmaPeripheral() = default;

  /// Returns the end of a transfer that begins at `start`. Returns kNever if the transfer waits for another event; the
  /// function is called again after that event.
  virtual Picoseconds end_time(const UdmaTransfer& transfer, Picoseconds start) = 0;
  /// Ends a transfer: copies its bytes.
  virtual void end(const UdmaTransfer& transfer) = 0;
  /// Cancels a transfer that has begun. No byte is copied.
  virtual void cancel(const UdmaTransfer& /*transfer*/, Picoseconds /*now*/) {}

  /// These functions access registers that the device's entry in the board file does not describe. They return false if
  /// there is no such register.
  virtual bool load(std::uint32_t /*offset*/, std::uint32_t& /*value*/) { return false; }
  virtual bool store(std::uint32_t /*offset*/, Picoseconds /*now*/, std::uint32_t /*value*/) { return false; }
  /// Called after a store into a register that the entry describes.
  virtual void registers_changed(std::uint32_t /*offset*/, Picoseconds /*now*/) {}

  /// These functions have the same meaning as those of a device: see mebots/soc/device.hpp.
  virtual double* input(std::string_view /*variable*/) { return nullptr; }
  virtual std::string_view* text_input(std::string_view /*variable*/) { return nullptr; }
  virtual std::span<const std::uint8_t>* bytes_input(std::string_view /*variable*/) { return nullptr; }
  virtual const double* output(std::string_view /*variable*/) const { return nullptr; }
  virtual void begin_step(Picoseconds /*now*/) {}
  virtual bool takes_picture() const { return false; }
  virtual void program_ended() {}

  virtual void visit(state::Visitor& v) = 0;
};

/// Services of the uDMA for its peripherals. Must outlive them.
struct UdmaHost {
  const BoardDevice& entry;
  DeviceHost& host;
  Signals& signals;
  std::function<double()> clock_hz;  // returns the clock of the SoC
  DescribedDevice registers;         // registers without effect

  std::uint32_t config(std::uint32_t offset) {
    std::uint32_t value = 0;
    registers.load(offset, 0, value);
    return value;
  }
  /// Returns the time that is `clocks` clock periods of the SoC after `time`.
  Picoseconds later(Picoseconds time, double clocks) const {
    return time + std::llround(clocks / clock_hz() * kPsPerS);
  }
  /// Reports a transfer whose address is not in memory.
  void complain_of_memory(std::uint32_t address, std::uint32_t size) const;
};

}  // namespace mebots::soc::gap8_devices
