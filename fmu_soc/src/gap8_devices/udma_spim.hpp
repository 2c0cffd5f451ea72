// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gap8_devices/udma_host.hpp"
#include "gap8_devices/udma_peripheral.hpp"

#include <cstdint>
#include <vector>

namespace mebots::soc::gap8_devices {

/// An SPI master of the uDMA with nothing connected: what its sending channel fetches are words of commands and, behind
/// a command that sends, of data; what it would receive are zeros. A bit takes twice the divider in clocks of the SoC,
/// or one with divider 0. The command that ends a transaction raises the event of the master. Source:
/// archi/udma/spim/udma_spim_v2.h.
class UdmaSpim final : public UdmaPeripheral {
 public:
  UdmaSpim(UdmaHost& host, std::uint32_t send_channel, unsigned end_event)
      : host_(host), send_channel_(send_channel), end_event_(end_event) {}

  Picoseconds end_time(const UdmaTransfer& transfer, Picoseconds start) override;
  void end(const UdmaTransfer& transfer) override;
  void visit(state::Visitor& v) override;

 private:
  struct Master {
    std::uint32_t divider = 0;
    std::uint32_t bits_to_send = 0;

    void visit(state::Visitor& v) {
      v("divider", divider);
      v("bits_to_send", bits_to_send);
    }
  };

  bool fetch(const UdmaTransfer& transfer);
  /// Obeys what was fetched; the answer is the SoC's clocks that it takes.
  double obey(Master& master, bool acts, Picoseconds now);

  UdmaHost& host_;
  std::uint32_t send_channel_;
  unsigned end_event_;
  Master master_;
  std::uint32_t bytes_to_receive_ = 0;  // that the slave has sent, and nobody fetched
  std::vector<std::uint8_t> bytes_;     // of a transfer
};

}  // namespace mebots::soc::gap8_devices
