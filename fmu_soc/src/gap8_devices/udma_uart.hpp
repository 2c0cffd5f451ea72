// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "devices/console.hpp"
#include "gap8_devices/udma_host.hpp"
#include "gap8_devices/udma_peripheral.hpp"

#include <cstdint>
#include <vector>

namespace mebots::soc::gap8_devices {

/// The UART's transmitter, with a terminal. A byte takes its bits, each CLKDIV + 1 clocks of the SoC. Source:
/// archi/udma/udma_uart_v1.h.
class UdmaUart final : public UdmaPeripheral {
 public:
  explicit UdmaUart(UdmaHost& host) : host_(host), terminal_(host.host) {}

  Picoseconds end_time(const UdmaTransfer& transfer, Picoseconds start) override;
  void end(const UdmaTransfer& transfer) override;
  bool load(std::uint32_t offset, std::uint32_t& value) override;
  void program_ended() override { terminal_.program_ended(); }
  void visit(state::Visitor& v) override {
    v("terminal", terminal_);
    v("sends", sends_);
  }

 private:
  UdmaHost& host_;
  Console terminal_;
  bool sends_ = false;
  std::vector<std::uint8_t> bytes_;  // of a transfer
};

}  // namespace mebots::soc::gap8_devices
