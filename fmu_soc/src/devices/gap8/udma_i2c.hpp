// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "devices/gap8/himax.hpp"
#include "devices/gap8/udma_peripheral.hpp"

#include <cstdint>
#include <vector>

namespace mebots::soc::gap8_devices {

/// Models an I2C master of the uDMA. Its sending channel fetches commands with operands (start, stop, write a byte,
/// read a byte, repeat, divider). Bytes that the master reads go to the receiving channel. A bit takes twice the
/// divider in SoC clocks, because the driver divides by half the baud rate. If the bus has no device, reads return
/// ones, as with a pulled-up line. Sources: archi/udma/i2c/udma_i2c_v1.h; GVSoC's udma_i2c_v2.
class UdmaI2c final : public UdmaPeripheral {
 public:
  /// `device` is the only device on the bus, or null if the bus has no device.
  UdmaI2c(UdmaHost& host, std::uint32_t send_channel, I2cDevice* device)
      : host_(host), send_channel_(send_channel), device_(device) {}

  Picoseconds end_time(const UdmaTransfer& transfer, Picoseconds start) override;
  void end(const UdmaTransfer& transfer) override;
  void visit(state::Visitor& v) override;

 private:
  /// Meaning of the next byte that the master fetches from the program's commands.
  enum class Next : std::uint32_t { command, divider_high, divider_low, repeats, data, waits };

  struct Master {
    Next next = Next::command;
    std::uint32_t divider = 0;
    std::uint32_t repeats = 1;
    bool is_address = false;  // the next byte to write is the address of a device
    bool is_selected = false;

    void visit(state::Visitor& v) {
      v("next", next);
      v("divider", divider);
      v("repeats", repeats);
      v("is_address", is_address);
      v("is_selected", is_selected);
    }
  };

  /// Executes one byte of the commands that the master fetches. Returns the number of SoC clocks that this byte takes.
  /// If `acts` is false, only computes this number.
  double obey(Master& master, std::uint8_t byte, bool acts, Picoseconds now);
  double command(Master& master, std::uint8_t byte, bool acts);
  void write(Master& master, std::uint8_t byte, Picoseconds now);
  bool fetch(const UdmaTransfer& transfer);

  UdmaHost& host_;
  std::uint32_t send_channel_;
  I2cDevice* device_;
  Master master_;
  std::vector<std::uint8_t> received_;
  std::vector<std::uint8_t> bytes_;  // bytes of the present transfer; a member so that its memory is reused
};

}  // namespace mebots::soc::gap8_devices
