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
  std::uint32_t channel = 0;  // which
  Picoseconds done_at = 0;    // of the first one in its queue; kNever = it waits for its peripheral

  void visit(state::Visitor& v) {
    v("address", address);
    v("size", size);
    v("outside", outside);
    v("channel", channel);
    v("done_at", done_at);
  }
};

/// What stands behind channels of the uDMA, with what is connected to it on the board. Offsets are those of the uDMA.
class UdmaPeripheral {
 public:
  UdmaPeripheral() = default;
  UdmaPeripheral(const UdmaPeripheral&) = delete;
  UdmaPeripheral& operator=(const UdmaPeripheral&) = delete;
  virtual ~UdmaPeripheral() = default;

  /// When a transfer that begins at `start` has ended; kNever = not before something else happens, behind which it is
  /// asked again.
  virtual Picoseconds end_time(const UdmaTransfer& transfer, Picoseconds start) = 0;
  /// It ends now: its bytes move.
  virtual void end(const UdmaTransfer& transfer) = 0;
  /// One that has begun is given up: nothing of it moves.
  virtual void cancel(const UdmaTransfer& /*transfer*/, Picoseconds /*now*/) {}

  /// Registers that the board's entry does not describe; false = none of its own there.
  virtual bool load(std::uint32_t /*offset*/, std::uint32_t& /*value*/) { return false; }
  virtual bool store(std::uint32_t /*offset*/, Picoseconds /*now*/, std::uint32_t /*value*/) { return false; }
  /// A register that the entry describes has been stored into.
  virtual void registers_changed(std::uint32_t /*offset*/, Picoseconds /*now*/) {}

  /// As a device's: mebots/soc/device.hpp.
  virtual double* input(std::string_view /*variable*/) { return nullptr; }
  virtual std::string_view* text_input(std::string_view /*variable*/) { return nullptr; }
  virtual std::span<const std::uint8_t>* bytes_input(std::string_view /*variable*/) { return nullptr; }
  virtual const double* output(std::string_view /*variable*/) const { return nullptr; }
  virtual void begin_step(Picoseconds /*now*/) {}
  virtual bool takes_picture() const { return false; }
  virtual void program_ended() {}

  virtual void visit(state::Visitor& v) = 0;
};

/// What the uDMA does for its peripherals. Lives longer than they do.
struct UdmaHost {
  const BoardDevice& entry;
  DeviceHost& host;
  Signals& signals;
  std::function<double()> clock_hz;  // of the SoC
  DescribedDevice registers;         // that keep what is stored

  std::uint32_t config(std::uint32_t offset) {
    std::uint32_t value = 0;
    registers.load(offset, 0, value);
    return value;
  }
  /// `clocks` of the SoC after a time.
  Picoseconds later(Picoseconds time, double clocks) const {
    return time + std::llround(clocks / clock_hz() * kPsPerS);
  }
  /// What a transfer has to do with memory that is not there.
  void complain_of_memory(std::uint32_t address, std::uint32_t size) const;
};

}  // namespace mebots::soc::gap8_devices
