// SPDX-License-Identifier: Apache-2.0
#include "devices/gap8/udma_i2c.hpp"

#include <algorithm>

namespace mebots::soc::gap8_devices {
namespace {

constexpr std::uint8_t kI2cStart = 0x00;
constexpr std::uint8_t kI2cStop = 0x20;
constexpr std::uint8_t kI2cReadAck = 0x40;
constexpr std::uint8_t kI2cReadNack = 0x60;
constexpr std::uint8_t kI2cWrite = 0x80;
constexpr std::uint8_t kI2cWait = 0xA0;
constexpr std::uint8_t kI2cRepeat = 0xC0;
constexpr std::uint8_t kI2cDivider = 0xE0;
constexpr std::uint8_t kCommandMask = 0xF0;
constexpr std::uint8_t kPulledUp = 0xff;
constexpr double kBitsPerByte = 9;  // including the acknowledge bit
constexpr double kClocksPerDivider = 2;

}  // namespace

bool UdmaI2c::fetch(const UdmaTransfer& transfer) {
  bytes_.resize(transfer.size);
  if (host_.host.read_memory(transfer.address, bytes_)) return true;
  host_.complain_of_memory(transfer.address, transfer.size);
  return false;
}

Picoseconds UdmaI2c::end_time(const UdmaTransfer& transfer, Picoseconds start) {
  if (transfer.channel != send_channel_) return received_.size() >= transfer.size ? start : kNever;
  if (!fetch(transfer)) return start;
  auto master = master_;
  double clocks = 0;
  for (const auto byte : bytes_) clocks += obey(master, byte, false, start);
  return host_.later(start, clocks);
}

void UdmaI2c::end(const UdmaTransfer& transfer) {
  if (transfer.channel == send_channel_) {
    if (!fetch(transfer)) return;
    for (const auto byte : bytes_) obey(master_, byte, true, transfer.done_at);
    return;
  }
  const auto size = static_cast<std::ptrdiff_t>(std::min<std::size_t>(transfer.size, received_.size()));
  bytes_.assign(received_.begin(), received_.begin() + size);
  received_.erase(received_.begin(), received_.begin() + size);
  if (!host_.host.write_memory(transfer.address, bytes_)) host_.complain_of_memory(transfer.address, transfer.size);
}

double UdmaI2c::obey(Master& master, std::uint8_t byte, bool acts, Picoseconds now) {
  switch (master.next) {
    case Next::command:
      return command(master, byte, acts);
    case Next::divider_high:
      master.divider = std::uint32_t{byte} << 8;
      master.next = Next::divider_low;
      return 0;
    case Next::divider_low:
      master.divider |= byte;
      master.next = Next::command;
      return 0;
    case Next::repeats:
      master.repeats = byte;
      master.next = Next::command;
      return 0;
    case Next::waits:
      master.next = Next::command;
      return byte;
    case Next::data:
      if (acts) write(master, byte, now);
      if (master.repeats > 0) --master.repeats;
      if (master.repeats == 0) {
        master.repeats = 1;
        master.next = Next::command;
      }
      return kBitsPerByte * kClocksPerDivider * master.divider;
  }
  return 0;
}

double UdmaI2c::command(Master& master, std::uint8_t byte, bool acts) {
  const auto bit = kClocksPerDivider * master.divider;
  switch (byte & kCommandMask) {
    case kI2cStart:
      master.is_address = true;
      return bit;
    case kI2cStop:
      master.is_selected = false;
      return bit;
    case kI2cReadAck:
    case kI2cReadNack: {
      const auto count = master.repeats;
      master.repeats = 1;
      if (acts) {
        for (std::uint32_t i = 0; i < count; ++i) received_.push_back(master.is_selected ? device_->read() : kPulledUp);
      }
      return bit * kBitsPerByte * count;
    }
    case kI2cWrite:
      master.next = Next::data;
      return 0;
    case kI2cWait:
      master.next = Next::waits;
      return 0;
    case kI2cRepeat:
      master.next = Next::repeats;
      return 0;
    case kI2cDivider:
      master.next = Next::divider_high;
      return 0;
    default:
      if (acts) host_.host.complain(host_.entry.name + ": I2C: an unknown command was ignored");
      return 0;
  }
}

void UdmaI2c::write(Master& master, std::uint8_t byte, Picoseconds now) {
  if (master.is_address) {
    master.is_address = false;
    master.is_selected = device_ != nullptr && byte >> 1 == device_->address();
    // A read continues at the address that the last write has set. Therefore only a write starts a new address.
    if (master.is_selected && (byte & 1U) == 0) device_->start();
  } else if (master.is_selected) {
    device_->write(byte, now);
  }
}

void UdmaI2c::visit(state::Visitor& v) {
  v("master", master_);
  v("received", received_);
}

}  // namespace mebots::soc::gap8_devices
