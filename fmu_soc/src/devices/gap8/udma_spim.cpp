// SPDX-License-Identifier: Apache-2.0
#include "devices/gap8/udma_spim.hpp"

#include "mebots/error.hpp"

#include <algorithm>
#include <cstring>

namespace mebots::soc::gap8_devices {
namespace {

/// Commands, which are in the upper four bits of a word.
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
      if (acts && master.sends_data) {
        const auto room = kWords * sizeof(std::uint16_t) - data_.size();
        const auto count = std::min<std::size_t>({(bits + 7) / 8, room, bytes_.size() - at});
        data_.insert(data_.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(at),
                     bytes_.begin() + static_cast<std::ptrdiff_t>(at + count));
      }
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
        master.sends_data = false;
        break;
      case kSpimDummy:
        pass_bits((word >> kSpimSizeShift & 0x1fU) + 1);
        break;
      case kSpimSendData:
        master.bits_to_send = (word & 0xffffU) + 1;
        master.sends_data = true;
        break;
      case kSpimReceiveData: {
        const auto bits = (word & 0xffffU) + 1;
        pass_bits(bits);
        if (acts) bytes_to_receive_ += (bits + 7) / 8;
        break;
      }
      case kSpimEnd:
        if (acts) publish_transaction(now);
        if (acts && (word & 1U) != 0) host_.signals.raise_soc_event(end_event_, now);
        break;
      case kSpimSelect:
      case kSpimWait:
        break;
      default:
        if (acts) host_.host.complain(host_.entry.name + ": SPI: a command that is not modelled was ignored");
        break;
    }
  }
  return clocks;
}

void UdmaSpim::publish_transaction(Picoseconds now) {
  if (data_.empty()) return;
  transactions_ += 1;
  data_.resize(kWords * sizeof(std::uint16_t));
  for (std::size_t i = 0; i < kWords; ++i) {
    sent_[i] = static_cast<std::int16_t>(data_[2 * i] | data_[2 * i + 1] << 8);
  }
  data_.clear();
  host_.host.setpoints_sent(name_, now);
}

const double* UdmaSpim::output(std::string_view variable) const {
  if (!variable.starts_with(name_)) return nullptr;
  variable.remove_prefix(name_.size());
  if (variable == ".transactions") return &transactions_;
  static constexpr std::array<std::string_view, kWords> kNames{".sent[0]", ".sent[1]", ".sent[2]", ".sent[3]"};
  const auto* const found = std::ranges::find(kNames, variable);
  return found == kNames.end() ? nullptr : &sent_[static_cast<std::size_t>(found - kNames.begin())];
}

void UdmaSpim::visit(state::Visitor& v) {
  v("master", master_);
  v("bytes_to_receive", bytes_to_receive_);
  v("data", data_);
  v("transactions", transactions_);
  v("sent", sent_);
  if (data_.size() > kWords * sizeof(std::uint16_t)) {
    throw Error(ErrorCode::state_damaged, "a saved state is damaged: an SPI master has sent more than it shows");
  }
}

}  // namespace mebots::soc::gap8_devices
