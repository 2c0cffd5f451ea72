// SPDX-License-Identifier: Apache-2.0
#include "gap8_devices/udma.hpp"

#include "mebots/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace mebots::soc::gap8_devices {
namespace {

/// Address, size and configuration from `offset` on; the line that it shares with others, and its event.
struct ChannelRow {
  std::uint32_t offset;
  std::size_t line;
  unsigned event;
};
constexpr std::size_t kHyperBus = 0;
constexpr std::size_t kUart = 1;
constexpr std::size_t kHyperSend = 1;
constexpr std::array<ChannelRow, 3> kRows{{{0x180, kHyperBus, 6}, {0x190, kHyperBus, 7}, {0x210, kUart, 9}}};

constexpr std::uint32_t kUartStatus = 0x220;
constexpr std::uint32_t kUartSetup = 0x224;
constexpr std::uint32_t kUartBusy = 1;
constexpr std::uint32_t kHyperOutside = 0x1A0;
constexpr std::uint32_t kHyperConfig4 = 0x1B8;
constexpr std::uint32_t kChannelAddress = 0x0;
constexpr std::uint32_t kChannelSize = 0x4;
constexpr std::uint32_t kChannelConfig = 0x8;
constexpr std::uint32_t kChannelBytes = 0xC;
constexpr std::uint32_t kRun = 1U << 4;     // written: start; read: one runs
constexpr std::uint32_t kQueued = 1U << 5;  // written: clear; read: one waits behind it
constexpr std::size_t kMostInQueue = 2;     // of a channel, that which runs included

constexpr double kBusClocksBefore = 3 + 12;
constexpr double kBytesPerBusClock = 2;
constexpr double kSocClocksPerBusClock = 2;
constexpr std::uint8_t kErased = 0xff;

/// The channel with this register; kRows.size() = none.
std::size_t channel_at(std::uint32_t offset) {
  const auto* const found = std::ranges::find_if(
      kRows, [&](const ChannelRow& row) { return offset >= row.offset && offset - row.offset < kChannelBytes; });
  return static_cast<std::size_t>(found - kRows.begin());
}

/// Clocks of the SoC that a byte takes: start, five to eight bits, parity, one or two stops.
double clocks_per_byte(std::uint32_t setup) {
  const auto bits = 1 + 5 + (setup >> 1 & 3U) + (setup & 1U) + 1 + (setup >> 3 & 1U);
  return static_cast<double>(bits) * ((setup >> 16) + 1.0);
}

}  // namespace

Udma::Udma(const BoardDevice& entry, DeviceHost& host, Signals& signals, std::span<const std::uint8_t> flash,
           std::function<double()> clock_hz)
    : entry_(entry),
      host_(host),
      signals_(signals),
      flash_(flash),
      clock_hz_(std::move(clock_hz)),
      registers_(entry, host),
      terminal_(host) {}

std::size_t Udma::queued(std::size_t channel) const {
  return static_cast<std::size_t>(std::ranges::count(queues_[kRows[channel].line], channel, &Transfer::channel));
}

bool Udma::load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) {
  if (offset == kHyperOutside) {
    value = outside_;
    return true;
  }
  if (offset == kUartStatus) {
    value = queues_[kUart].empty() ? 0 : kUartBusy;
    return true;
  }
  const auto channel = channel_at(offset);
  if (channel == kRows.size()) return registers_.load(offset, now, value);
  const auto reg = offset - kRows[channel].offset;
  const auto waiting = queued(channel);
  value = reg == kChannelAddress ? channels_[channel].address
          : reg == kChannelSize  ? channels_[channel].size
                                 : (waiting > 0 ? kRun : 0U) | (waiting >= kMostInQueue ? kQueued : 0U);
  return true;
}

bool Udma::store(std::uint32_t offset, Picoseconds now, std::uint32_t value) {
  if (offset == kHyperOutside) {
    outside_ = value;
    return true;
  }
  const auto channel = channel_at(offset);
  if (channel == kRows.size()) return registers_.store(offset, now, value);
  const auto reg = offset - kRows[channel].offset;
  if (reg == kChannelAddress) channels_[channel].address = value;
  if (reg == kChannelSize) channels_[channel].size = value;
  if (reg == kChannelConfig && (value & kQueued) != 0) {
    std::erase_if(queues_[kRows[channel].line], [&](const Transfer& transfer) { return transfer.channel == channel; });
  }
  if (reg == kChannelConfig && (value & kRun) != 0) enqueue(channel, now);
  return true;
}

void Udma::enqueue(std::size_t channel, Picoseconds now) {
  if (queued(channel) >= kMostInQueue) {
    host_.complain(
        fmt::format("{}: a third transfer of the channel at 0x{:08x} is lost: look at bit 5 of its CFG first",
                    entry_.name, entry_.base + kRows[channel].offset));
    return;
  }
  auto& queue = queues_[kRows[channel].line];
  queue.push_back({channels_[channel], outside_, static_cast<std::uint32_t>(channel), 0});
  if (queue.size() == 1) start(queue.front(), now);
}

void Udma::start(Transfer& transfer, Picoseconds now) const {
  const auto size = transfer.inside.size;
  const auto clocks = kRows[transfer.channel].line == kUart
                          ? size * clocks_per_byte(config(kUartSetup))
                          : (kBusClocksBefore + size / kBytesPerBusClock) * kSocClocksPerBusClock;
  transfer.done_at = now + std::llround(clocks / clock_hz_() * kPsPerS);
}

Picoseconds Udma::next_event() const {
  auto next = kNever;
  for (const auto& queue : queues_) {
    if (!queue.empty()) next = std::min(next, queue.front().done_at);
  }
  return next;
}

void Udma::advance(Picoseconds now) {
  for (auto& queue : queues_) {
    while (!queue.empty() && now >= queue.front().done_at) {
      const auto transfer = queue.front();
      queue.erase(queue.begin());
      end(transfer);
      signals_.raise_soc_event(kRows[transfer.channel].event, now);
      if (!queue.empty()) start(queue.front(), transfer.done_at);
    }
  }
}

void Udma::end(const Transfer& transfer) {
  kRows[transfer.channel].line == kUart ? print(transfer) : move(transfer);
}

/// What stands in a register that the entry describes.
std::uint32_t Udma::config(std::uint32_t offset) const {
  std::uint32_t value = 0;
  registers_.load(offset, 0, value);
  return value;
}

void Udma::print(const Transfer& transfer) {
  bytes_.resize(transfer.inside.size);
  if (!host_.read_memory(transfer.inside.address, bytes_)) {
    host_.complain(fmt::format("{}: UART: no memory of {} bytes at 0x{:08x}", entry_.name, transfer.inside.size,
                               transfer.inside.address));
    return;
  }
  for (const auto byte : bytes_) terminal_.put(byte, transfer.done_at);
}

void Udma::move(const Transfer& transfer) {
  const auto base = (config(kHyperConfig4) & 0xffU) << 24;
  const bool is_flash = transfer.outside >= base;
  const auto place = is_flash ? transfer.outside - base : transfer.outside;
  const auto room = is_flash ? kFlashBytes : kRamBytes;
  const auto size = transfer.inside.size;
  const auto complain = [&](std::string_view what) {
    host_.complain(fmt::format("{}: transfer of {} bytes between 0x{:08x} and 0x{:08x} of the HyperBus: {}",
                               entry_.name, size, transfer.inside.address, transfer.outside, what));
  };
  if (place > room || size > room - place) return complain("the memory there ends before");
  bytes_.resize(size);
  if (transfer.channel == kHyperSend) {
    if (is_flash) return complain("the flash's commands are not modelled: nothing was written");
    if (!host_.read_memory(transfer.inside.address, bytes_)) return complain("no memory of the chip there");
    if (ram_.size() < place + size) ram_.resize(place + size);
    std::ranges::copy(bytes_, ram_.begin() + place);
    return;
  }
  const auto source = is_flash ? flash_ : std::span<const std::uint8_t>(ram_);
  const auto there = place < source.size() ? std::min<std::size_t>(size, source.size() - place) : 0;
  std::copy_n(source.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(place, source.size())), there,
              bytes_.begin());
  std::fill(bytes_.begin() + static_cast<std::ptrdiff_t>(there), bytes_.end(), is_flash ? kErased : std::uint8_t{0});
  if (!host_.write_memory(transfer.inside.address, bytes_)) complain("no memory of the chip there");
}

void Udma::visit(state::Visitor& v) {
  v("registers", registers_);
  v("terminal", terminal_);
  v("channels", channels_);
  v("queues", queues_);
  v("outside", outside_);
  v("ram", ram_);
  for (const auto& queue : queues_) {
    for (const auto& transfer : queue) {
      if (transfer.channel >= kRows.size()) {
        throw Error(ErrorCode::state_damaged, "a saved state is damaged: a transfer is of no channel");
      }
    }
  }
}

}  // namespace mebots::soc::gap8_devices
