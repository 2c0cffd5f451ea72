// SPDX-License-Identifier: Apache-2.0
#include "devices/gap8/udma_uart.hpp"

namespace mebots::soc::gap8_devices {
namespace {

constexpr std::uint32_t kUartStatus = 0x220;
constexpr std::uint32_t kUartSetup = 0x224;
constexpr std::uint32_t kUartBusy = 1;

/// Returns the number of SoC clocks that a byte takes: start bit, five to eight bits, parity, one or two stop bits.
double clocks_per_byte(std::uint32_t setup) {
  const auto bits = 1 + 5 + (setup >> 1 & 3U) + (setup & 1U) + 1 + (setup >> 3 & 1U);
  return static_cast<double>(bits) * ((setup >> 16) + 1.0);
}

}  // namespace

Picoseconds UdmaUart::end_time(const UdmaTransfer& transfer, Picoseconds start) {
  if (transfer.channel == receive_channel_) return kNever;
  sends_ = true;
  return host_.later(start, transfer.size * clocks_per_byte(host_.config(kUartSetup)));
}

void UdmaUart::end(const UdmaTransfer& transfer) {
  sends_ = false;
  bytes_.resize(transfer.size);
  if (!host_.host.read_memory(transfer.address, bytes_)) {
    host_.complain_of_memory(transfer.address, transfer.size);
    return;
  }
  for (const auto byte : bytes_) terminal_.put(byte, transfer.done_at);
}

bool UdmaUart::load(std::uint32_t offset, std::uint32_t& value) {
  if (offset != kUartStatus) return false;
  value = sends_ ? kUartBusy : 0;
  return true;
}

}  // namespace mebots::soc::gap8_devices
