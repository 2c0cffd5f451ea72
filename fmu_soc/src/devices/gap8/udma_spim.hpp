// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "devices/gap8/udma_peripheral.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace mebots::soc::gap8_devices {

/// Models an SPI master of the uDMA with a slave that only receives. The sending channel fetches command words and,
/// after a command that sends, data. Received data are zeros. A bit takes twice the divider in SoC clocks, or one clock
/// if the divider is 0. The command that ends a transaction raises the master's event if bit 0 of
/// the command is set. Source: archi/udma/spim/udma_spim_v2.h.
///
/// Variables begin with spim0 or spim1. .transactions counts the transactions that sent data. .sent[0] to .sent[3] are
/// the first 16-bit words of the last such transaction, signed, low byte first.
class UdmaSpim final : public UdmaPeripheral {
 public:
  UdmaSpim(UdmaHost& host, std::string_view name, std::uint32_t send_channel, unsigned end_event)
      : host_(host), name_(name), send_channel_(send_channel), end_event_(end_event) {}

  Picoseconds end_time(const UdmaTransfer& transfer, Picoseconds start) override;
  void end(const UdmaTransfer& transfer) override;
  const double* output(std::string_view variable) const override;
  void visit(state::Visitor& v) override;

 private:
  struct Master {
    std::uint32_t divider = 0;
    std::uint32_t bits_to_send = 0;
    bool sends_data = false;  // true if the next bits are data, false if they are an address

    void visit(state::Visitor& v) {
      v("divider", divider);
      v("bits_to_send", bits_to_send);
      v("sends_data", sends_data);
    }
  };

  static constexpr std::size_t kWords = 4;  // number of words in the variables .sent

  bool fetch(const UdmaTransfer& transfer);
  /// Executes the fetched words. Returns the number of SoC clocks that they take. If `acts` is false, only computes
  /// this number.
  double obey(Master& master, bool acts, Picoseconds now);
  void publish_transaction(Picoseconds now);

  UdmaHost& host_;
  std::string_view name_;
  std::uint32_t send_channel_;
  unsigned end_event_;
  Master master_;
  std::uint32_t bytes_to_receive_ = 0;  // bytes that were received, but not fetched by a transfer
  std::vector<std::uint8_t> bytes_;     // bytes of the present transfer; a member so that its memory is reused
  std::vector<std::uint8_t> data_;      // bytes sent in this transaction, at most kWords words

  // Variables of the FMU.
  double transactions_ = 0;
  std::array<double, kWords> sent_{};
};

}  // namespace mebots::soc::gap8_devices
