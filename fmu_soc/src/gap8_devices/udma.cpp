// SPDX-License-Identifier: Apache-2.0
#include "gap8_devices/udma.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace mebots::soc::gap8_devices {
namespace {

constexpr std::uint32_t kHyperReceive = 0x180;  // address, size, configuration
constexpr std::uint32_t kHyperSend = 0x190;
constexpr std::uint32_t kHyperOutside = 0x1A0;
constexpr std::uint32_t kHyperConfig4 = 0x1B8;
constexpr std::uint32_t kChannelAddress = 0x0;
constexpr std::uint32_t kChannelSize = 0x4;
constexpr std::uint32_t kChannelConfig = 0x8;
constexpr std::uint32_t kChannelBytes = 0xC;
constexpr std::uint32_t kRun = 1U << 4;     // written: start; read: one runs
constexpr std::uint32_t kQueued = 1U << 5;  // written: clear; read: one waits behind it
constexpr std::size_t kMostQueued = 2;      // of a channel, that which runs included
constexpr unsigned kReceiveEvent = 6;
constexpr unsigned kSendEvent = 7;

constexpr double kBusClocksBefore = 3 + 12;
constexpr double kBytesPerBusClock = 2;
constexpr double kSocClocksPerBusClock = 2;
constexpr std::uint8_t kErased = 0xff;

/// The offset in a channel; nothing when the register is none of it.
std::optional<std::uint32_t> in_channel(std::uint32_t offset, std::uint32_t channel) {
  if (offset < channel || offset - channel >= kChannelBytes) return std::nullopt;
  return offset - channel;
}

}  // namespace

Udma::Udma(const BoardDevice& entry, DeviceHost& host, Signals& signals, std::span<const std::uint8_t> flash,
           std::function<double()> clock_hz)
    : entry_(entry),
      host_(host),
      signals_(signals),
      flash_(flash),
      clock_hz_(std::move(clock_hz)),
      registers_(entry, host) {}

std::size_t Udma::queued(bool sends) const {
  return static_cast<std::size_t>(std::ranges::count(queue_, sends, &Transfer::sends));
}

bool Udma::load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) {
  if (offset == kHyperOutside) {
    value = outside_;
    return true;
  }
  for (const bool sends : {false, true}) {
    const auto reg = in_channel(offset, sends ? kHyperSend : kHyperReceive);
    if (!reg) continue;
    const auto& channel = sends ? send_ : receive_;
    const auto waiting = queued(sends);
    value = *reg == kChannelAddress ? channel.address
            : *reg == kChannelSize  ? channel.size
                                    : (waiting > 0 ? kRun : 0U) | (waiting >= kMostQueued ? kQueued : 0U);
    return true;
  }
  return registers_.load(offset, now, value);
}

bool Udma::store(std::uint32_t offset, Picoseconds now, std::uint32_t value) {
  if (offset == kHyperOutside) {
    outside_ = value;
    return true;
  }
  for (const bool sends : {false, true}) {
    const auto reg = in_channel(offset, sends ? kHyperSend : kHyperReceive);
    if (!reg) continue;
    auto& channel = sends ? send_ : receive_;
    if (*reg == kChannelAddress) channel.address = value;
    if (*reg == kChannelSize) channel.size = value;
    if (*reg == kChannelConfig && (value & kQueued) != 0) {
      std::erase_if(queue_, [&](const Transfer& transfer) { return transfer.sends == sends; });
    }
    if (*reg == kChannelConfig && (value & kRun) != 0) enqueue(sends, now);
    return true;
  }
  return registers_.store(offset, now, value);
}

void Udma::enqueue(bool sends, Picoseconds now) {
  if (queued(sends) >= kMostQueued) {
    host_.complain(
        fmt::format("{}: a third transfer of the HyperBus's {} channel is lost: look at bit 5 of its CFG first",
                    entry_.name, sends ? "sending" : "receiving"));
    return;
  }
  queue_.push_back({sends ? send_ : receive_, outside_, sends, 0});
  if (queue_.size() == 1) start(now);
}

void Udma::start(Picoseconds now) {
  auto& transfer = queue_.front();
  const auto bus_clocks = kBusClocksBefore + transfer.inside.size / kBytesPerBusClock;
  transfer.done_at = now + std::llround(bus_clocks * kSocClocksPerBusClock / clock_hz_() * kPsPerS);
}

void Udma::advance(Picoseconds now) {
  while (!queue_.empty() && now >= queue_.front().done_at) {
    const auto transfer = queue_.front();
    queue_.erase(queue_.begin());
    move(transfer);
    signals_.raise_soc_event(transfer.sends ? kSendEvent : kReceiveEvent, now);
    if (!queue_.empty()) start(transfer.done_at);
  }
}

std::uint32_t Udma::flash_base() {
  std::uint32_t config = 0;
  registers_.load(kHyperConfig4, 0, config);
  return (config & 0xffU) << 24;
}

void Udma::move(const Transfer& transfer) {
  const auto base = flash_base();
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
  if (transfer.sends) {
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
  v("receive", receive_);
  v("send", send_);
  v("outside", outside_);
  v("queue", queue_);
  v("ram", ram_);
}

}  // namespace mebots::soc::gap8_devices
