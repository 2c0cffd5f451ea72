// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "devices/gap8/udma_peripheral.hpp"
#include "devices/generic/console.hpp"

#include <cstdint>
#include <vector>

namespace mebots::soc::gap8_devices {

/// Models the UART with a terminal that prints the bytes it receives, and sends nothing. A transfer on the receiving
/// channel therefore waits until the program clears it. A bit takes CLKDIV + 1 clocks of the SoC. Source:
/// archi/udma/udma_uart_v1.h.
class UdmaUart final : public UdmaPeripheral {
 public:
  UdmaUart(UdmaHost& host, std::uint32_t receive_channel)
      : host_(host), receive_channel_(receive_channel), terminal_(host.host) {}

  Picoseconds end_time(const UdmaTransfer& transfer, Picoseconds start) override;
  void end(const UdmaTransfer& transfer) override;
  void cancel(const UdmaTransfer& transfer, Picoseconds /*now*/) override {
    if (transfer.channel != receive_channel_) sends_ = false;
  }
  bool load(std::uint32_t offset, std::uint32_t& value) override;
  void program_ended() override { terminal_.program_ended(); }
  void visit(state::Visitor& v) override {
    v("terminal", terminal_);
    v("sends", sends_);
  }

 private:
  UdmaHost& host_;
  std::uint32_t receive_channel_;
  Console terminal_;
  bool sends_ = false;
  std::vector<std::uint8_t> bytes_;  // bytes of the present transfer; a member so that its memory is reused
};

}  // namespace mebots::soc::gap8_devices
