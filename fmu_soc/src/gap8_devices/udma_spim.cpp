// SPDX-License-Identifier: Apache-2.0
#include "gap8_devices/udma_spim.hpp"

#include <algorithm>
#include <cstring>

namespace mebots::soc::gap8_devices {
namespace {

/// Commands: the upper four bits of a word.
constexpr std::uint32_t kSpimConfig = 0;
constexpr std::uint32_t kSpimSelect = 1;
constexpr std::uint32_t kSpimSendCommand = 2;
constexpr std::uint32_t kSpimSendAddress = 3;
constexpr std::uint32_t kSpimDummy = 4;
constexpr std::uint32_t kSpimWait = 5;
constexpr std::uint32_t kSpimSendData = 6;
constexpr std::uint32_t kSpimReceiveData = 7;
constexpr std::uint32_t kSpimEnd = 9;
constexpr unsigned kSpimCommandShift = 28;
constexpr unsigned kSpimSizeShift = 16;
constexpr std::uint32_t kWordBits = 32;

}  // namespace

bool UdmaSpim::fetch(const UdmaTransfer& transfer) {
  bytes_.resize(transfer.size);
  if (host_.host.read_memory(transfer.address, bytes_)) return true;
  host_.complain_of_memory(transfer.address, transfer.size);
  return false;
}

Picoseconds UdmaSpim::end_time(const UdmaTransfer& transfer, Picoseconds start) {
  if (transfer.channel != send_channel_) return bytes_to_receive_ >= transfer.size ? start : kNever;
  if (!fetch(transfer)) return start;
  auto master = master_;
  return host_.later(start, obey(master, false, start));
}

void UdmaSpim::end(const UdmaTransfer& transfer) {
  if (transfer.channel == send_channel_) {
    if (fetch(transfer)) obey(master_, true, transfer.done_at);
    return;
  }
  bytes_.assign(transfer.size, 0);
  bytes_to_receive_ -= std::min(bytes_to_receive_, transfer.size);
  if (!host_.host.write_memory(transfer.address, bytes_)) host_.complain_of_memory(transfer.address, transfer.size);
}

double UdmaSpim::obey(Master& master, bool acts, Picoseconds now) {
  double clocks = 0;
  const auto pass_bits = [&](std::uint32_t bits) {
    clocks += bits * (master.divider == 0 ? 1.0 : 2.0 * master.divider);
  };
  for (std::size_t at = 0; at < bytes_.size(); at += sizeof(std::uint32_t)) {
    std::uint32_t word = 0;
    std::memcpy(&word, bytes_.data() + at, std::min(sizeof word, bytes_.size() - at));
    if (master.bits_to_send > 0) {
      const auto bits = std::min(master.bits_to_send, kWordBits);
      master.bits_to_send -= bits;
      pass_bits(bits);
      continue;
    }
    switch (word >> kSpimCommandShift) {
      case kSpimConfig:
        master.divider = word & 0xffU;
        break;
      case kSpimSendCommand:
        pass_bits((word >> kSpimSizeShift & 0xfU) + 1);
        break;
      case kSpimSendAddress:
        master.bits_to_send = (word >> kSpimSizeShift & 0x1fU) + 1;
        break;
      case kSpimDummy:
        pass_bits((word >> kSpimSizeShift & 0x1fU) + 1);
        break;
      case kSpimSendData:
        master.bits_to_send = (word & 0xffffU) + 1;
        break;
      case kSpimReceiveData: {
        const auto bits = (word & 0xffffU) + 1;
        pass_bits(bits);
        if (acts) bytes_to_receive_ += (bits + 7) / 8;
        break;
      }
      case kSpimEnd:
        if (acts && (word & 1U) != 0) host_.signals.raise_soc_event(end_event_, now);
        break;
      case kSpimSelect:
      case kSpimWait:
        break;
      default:
        if (acts) host_.host.complain(host_.entry.name + ": SPI: a command that is not modelled was passed over");
        break;
    }
  }
  return clocks;
}

void UdmaSpim::visit(state::Visitor& v) {
  v("master", master_);
  v("bytes_to_receive", bytes_to_receive_);
}

}  // namespace mebots::soc::gap8_devices
