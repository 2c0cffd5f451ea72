// SPDX-License-Identifier: Apache-2.0
#include "devices/gap8/udma_hyperbus.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace mebots::soc::gap8_devices {
namespace {

constexpr std::uint32_t kHyperConfig4 = 0x1B8;
constexpr double kBusClocksBefore = 3 + 12;
constexpr double kBytesPerBusClock = 2;
constexpr double kSocClocksPerBusClock = 2;

}  // namespace

std::uint32_t UdmaHyperBus::flash_base() const {
  return (host_.config(kHyperConfig4) & 0xffU) << 24;
}

Picoseconds UdmaHyperBus::end_time(const UdmaTransfer& transfer, Picoseconds start) {
  (is_of_flash(transfer) ? parts_.flash : parts_.ram).begin(start);
  parts_.pads.begin(start);
  return host_.later(start, (kBusClocksBefore + transfer.size / kBytesPerBusClock) * kSocClocksPerBusClock);
}

void UdmaHyperBus::end(const UdmaTransfer& transfer) {
  release(transfer.done_at, transfer.size, is_of_flash(transfer));
  move(transfer);
}

void UdmaHyperBus::cancel(const UdmaTransfer& /*transfer*/, Picoseconds now) {
  release(now, 0, false);
}

/// Sets both memories to idle, because the border between RAM and flash may have moved during the transfer.
void UdmaHyperBus::release(Picoseconds now, std::uint32_t bytes, bool of_flash) {
  parts_.ram.end(now, of_flash ? 0 : bytes);
  parts_.flash.end(now, of_flash ? bytes : 0);
  parts_.pads.end(now, bytes);
}

void UdmaHyperBus::move(const UdmaTransfer& transfer) {
  const auto base = flash_base();
  const bool is_flash = is_of_flash(transfer);
  const auto place = is_flash ? transfer.outside - base : transfer.outside;
  const auto room = is_flash ? kFlashBytes : kRamBytes;
  const auto size = transfer.size;
  const auto complain = [&](std::string_view what) {
    host_.host.complain(fmt::format("{}: transfer of {} bytes between 0x{:08x} and 0x{:08x} of the HyperBus: {}",
                                    host_.entry.name, size, transfer.address, transfer.outside, what));
  };
  if (place > room || size > room - place) return complain("the memory ends before the last byte");
  bytes_.resize(size);
  if (transfer.channel == send_channel_) {
    if (!host_.host.read_memory(transfer.address, bytes_)) return complain("the chip has no memory there");
    if (is_flash) {
      if (!flash_.write(place, bytes_))
        complain("this is not a command of the flash, or its order is wrong: nothing was written");
      return;
    }
    if (ram_.size() < place + size) ram_.resize(place + size);
    std::ranges::copy(bytes_, ram_.begin() + place);
    return;
  }
  if (is_flash) {
    flash_.read(place, bytes_);
  } else {
    const auto there = place < ram_.size() ? std::min<std::size_t>(size, ram_.size() - place) : 0;
    std::copy_n(ram_.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(place, ram_.size())), there,
                bytes_.begin());
    std::fill(bytes_.begin() + static_cast<std::ptrdiff_t>(there), bytes_.end(), std::uint8_t{0});
  }
  if (!host_.host.write_memory(transfer.address, bytes_)) complain("the chip has no memory there");
}

}  // namespace mebots::soc::gap8_devices
