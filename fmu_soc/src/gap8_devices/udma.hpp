// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "devices/console.hpp"
#include "devices/described_device.hpp"
#include "gap8_devices/signals.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace mebots::soc::gap8_devices {

/// GAP8's uDMA with the channels of its HyperBus and of its UART's transmitter, and what a GAPuino has there: 8 MiB of
/// RAM, flash from MEM_CFG4's MBR1 on (16 MiB after reset), a terminal. A store into a channel's CFG with the enable
/// bit starts a transfer, or queues one behind that which runs; its end is the channel's SoC event. Bytes move when the
/// transfer ends.
///
/// A transfer on the HyperBus takes 3 clocks of the bus for command and address, 12 of latency, and one for two bytes
/// (HyperBus specification, fixed latency of 6 clocks twice); the bus has half the clock of the SoC, which is ours: no
/// source. A byte on the UART takes its bits, each CLKDIV + 1 clocks of the SoC.
///
/// Other peripherals' channels are as the entry describes them. Sources: archi/udma/udma_v2.h, udma_hyper_v1.h,
/// udma_uart_v1.h.
class Udma final : public Device {
 public:
  static constexpr std::uint32_t kRamBytes = 8U << 20;     // S71KS512S, the GAPuino's HyperBus memory
  static constexpr std::uint32_t kFlashBytes = 64U << 20;  // likewise

  /// `flash` holds the image that the flash begins with, all ones behind it; it must stay where it is.
  Udma(const BoardDevice& entry, DeviceHost& host, Signals& signals, std::span<const std::uint8_t> flash,
       std::function<double()> clock_hz);

  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override;
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override;
  void advance(Picoseconds now) override;
  Picoseconds next_event() const override;
  void program_ended() override { terminal_.program_ended(); }
  void visit(state::Visitor& v) override;

 private:
  struct Channel {
    std::uint32_t address = 0;
    std::uint32_t size = 0;

    void visit(state::Visitor& v) {
      v("address", address);
      v("size", size);
    }
  };
  struct Transfer {
    Channel inside;             // address and size in the chip's memory
    std::uint32_t outside = 0;  // address on the HyperBus
    std::uint32_t channel = 0;  // which
    Picoseconds done_at = 0;    // of the first one in the queue

    void visit(state::Visitor& v) {
      v("inside", inside);
      v("outside", outside);
      v("channel", channel);
      v("done_at", done_at);
    }
  };
  using Queue = std::vector<Transfer>;

  static constexpr std::size_t kChannels = 3;
  static constexpr std::size_t kLines = 2;  // HyperBus, UART

  std::size_t queued(std::size_t channel) const;
  void enqueue(std::size_t channel, Picoseconds now);
  void start(Transfer& transfer, Picoseconds now) const;
  void end(const Transfer& transfer);
  void move(const Transfer& transfer);
  void print(const Transfer& transfer);
  std::uint32_t config(std::uint32_t offset) const;

  const BoardDevice& entry_;
  DeviceHost& host_;
  Signals& signals_;
  std::span<const std::uint8_t> flash_;
  std::function<double()> clock_hz_;
  mutable DescribedDevice registers_;  // a load of it changes nothing
  Console terminal_;
  std::array<Channel, kChannels> channels_;
  std::array<Queue, kLines> queues_;
  std::uint32_t outside_ = 0;
  std::vector<std::uint8_t> ram_;    // as far as it has been written
  std::vector<std::uint8_t> bytes_;  // of a transfer
};

}  // namespace mebots::soc::gap8_devices
