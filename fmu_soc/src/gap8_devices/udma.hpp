// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "devices/described_device.hpp"
#include "gap8_devices/signals.hpp"

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace mebots::soc::gap8_devices {

/// GAP8's uDMA with what a GAPuino has at its HyperBus: 8 MiB of RAM, and flash from MEM_CFG4's MBR1 on (16 MiB after
/// reset). A store into a channel's CFG with the enable bit starts a transfer, or queues one behind that which runs;
/// its end is the channel's SoC event. Bytes move when the transfer ends.
///
/// A transfer takes 3 clocks of the bus for command and address, 12 of latency, and one for two bytes (HyperBus
/// specification, fixed latency of 6 clocks twice); the bus has half the clock of the SoC, which is ours: no source.
///
/// Other peripherals' channels are as the entry describes them. Sources: archi/udma/udma_v2.h, udma_hyper_v1.h.
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
  Picoseconds next_event() const override { return queue_.empty() ? kNever : queue_.front().done_at; }
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
    bool sends = false;         // from the chip
    Picoseconds done_at = 0;    // of the first one in the queue

    void visit(state::Visitor& v) {
      v("inside", inside);
      v("outside", outside);
      v("sends", sends);
      v("done_at", done_at);
    }
  };

  std::size_t queued(bool sends) const;
  void enqueue(bool sends, Picoseconds now);
  void start(Picoseconds now);
  void move(const Transfer& transfer);
  std::uint32_t flash_base();

  const BoardDevice& entry_;
  DeviceHost& host_;
  Signals& signals_;
  std::span<const std::uint8_t> flash_;
  std::function<double()> clock_hz_;
  DescribedDevice registers_;
  Channel receive_;
  Channel send_;
  std::uint32_t outside_ = 0;
  std::vector<Transfer> queue_;
  std::vector<std::uint8_t> ram_;    // as far as it has been written
  std::vector<std::uint8_t> bytes_;  // of a transfer
};

}  // namespace mebots::soc::gap8_devices
