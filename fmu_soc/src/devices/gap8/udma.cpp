// SPDX-License-Identifier: Apache-2.0
#include "devices/gap8/udma.hpp"

#include "devices/core/kinds.hpp"
#include "mebots/assert.hpp"
#include "mebots/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

namespace mebots::soc::gap8_devices {
namespace {

enum class Behind : std::uint8_t { hyper_bus, uart, i2c0, i2c1, spim0, spim1, camera };

/// Describes a channel: offset of its registers (address, size and configuration), peripheral, index of its queue, and
/// SoC event. Channels may share a queue.
struct ChannelRow {
  std::uint32_t offset;
  Behind behind;
  std::size_t line;
  unsigned event;
};
constexpr std::array<ChannelRow, 13> kChannelRows{{
    {0x080, Behind::spim0, 0, 2},
    {0x090, Behind::spim0, 1, 3},
    {0x100, Behind::spim1, 2, 4},
    {0x110, Behind::spim1, 3, 5},
    {0x180, Behind::hyper_bus, 4, 6},
    {0x190, Behind::hyper_bus, 4, 7},
    {0x200, Behind::uart, 11, 8},
    {0x210, Behind::uart, 5, 9},
    {0x280, Behind::i2c0, 6, 10},
    {0x290, Behind::i2c0, 7, 11},
    {0x300, Behind::i2c1, 8, 12},
    {0x310, Behind::i2c1, 9, 13},
    {0x480, Behind::camera, 10, 18},
}};
constexpr std::uint32_t kSpim0Send = 1;
constexpr std::uint32_t kSpim1Send = 3;
constexpr std::uint32_t kHyperSend = 5;
constexpr std::uint32_t kUartReceive = 6;
constexpr std::uint32_t kI2c0Send = 9;
constexpr std::uint32_t kI2c1Send = 11;
constexpr unsigned kSpim0End = 22;
constexpr unsigned kSpim1End = 23;

constexpr std::uint32_t kHyperOutside = 0x1A0;
constexpr std::uint32_t kChannelAddress = 0x0;
constexpr std::uint32_t kChannelSize = 0x4;
constexpr std::uint32_t kChannelConfig = 0x8;
constexpr std::uint32_t kChannelBytes = 0xC;
constexpr std::uint32_t kRun = 1U << 4;     // store: starts a transfer; load: a transfer runs
constexpr std::uint32_t kQueued = 1U << 5;  // store: cancels the transfers; load: another transfer is queued
constexpr std::size_t kMostInQueue = 2;     // transfers of a channel, including the one that runs

/// Returns the channel to which the register at this offset belongs. If it belongs to no channel, returns
/// kChannelRows.size().
std::size_t channel_at(std::uint32_t offset) {
  const auto* const found = std::ranges::find_if(
      kChannelRows, [&](const ChannelRow& row) { return offset >= row.offset && offset - row.offset < kChannelBytes; });
  return static_cast<std::size_t>(found - kChannelRows.begin());
}

}  // namespace

void UdmaHost::complain_of_memory(std::uint32_t address, std::uint32_t size) const {
  host.complain(
      fmt::format("{}: no memory of {} bytes at 0x{:08x}: the transfer moved nothing", entry.name, size, address));
}

Udma::Udma(const BoardDevice& entry, DeviceHost& host, Signals& signals, std::span<const std::uint8_t> flash,
           const PictureRoll& pictures, std::function<double()> clock_hz, const UdmaParts& parts)
    : host_{entry, host, signals, std::move(clock_hz), {entry, host}},
      sensor_(parts.camera),
      hyper_bus_(host_, flash, kHyperSend, parts.hyper_bus),
      uart_(host_, kUartReceive),
      i2c_{{{host_, kI2c0Send, &sensor_}, {host_, kI2c1Send, &sensor_}}},
      spim_{{{host_, "spim0", kSpim0Send, kSpim0End}, {host_, "spim1", kSpim1Send, kSpim1End}}},
      camera_(host_, sensor_, pictures) {}

UdmaPeripheral& Udma::peripheral(std::size_t channel) {
  MEBOTS_ASSERT(channel < kChannelRows.size());
  switch (kChannelRows[channel].behind) {
    case Behind::hyper_bus:
      return hyper_bus_;
    case Behind::uart:
      return uart_;
    case Behind::i2c0:
      return i2c_[0];
    case Behind::i2c1:
      return i2c_[1];
    case Behind::spim0:
      return spim_[0];
    case Behind::spim1:
      return spim_[1];
    case Behind::camera:
      break;
  }
  return camera_;
}

std::size_t Udma::queued(std::size_t channel) const {
  return static_cast<std::size_t>(
      std::ranges::count(queues_[kChannelRows[channel].line], channel, &UdmaTransfer::channel));
}

bool Udma::load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) {
  if (offset == kHyperOutside) {
    value = outside_;
    return true;
  }
  if (uart_.load(offset, value)) return true;
  const auto channel = channel_at(offset);
  if (channel == kChannelRows.size()) return host_.registers.load(offset, now, value);
  const auto reg = offset - kChannelRows[channel].offset;
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
  if (channel == kChannelRows.size()) {
    const bool known = host_.registers.store(offset, now, value);
    camera_.registers_changed(offset, now);
    retry_waiting_transfers(now);
    return known;
  }
  const auto reg = offset - kChannelRows[channel].offset;
  if (reg == kChannelAddress) channels_[channel].address = value;
  if (reg == kChannelSize) channels_[channel].size = value;
  if (reg == kChannelConfig && (value & kQueued) != 0) clear(channel, now);
  if (reg == kChannelConfig && (value & kRun) != 0) enqueue(channel, now);
  return true;
}

/// Cancels the channel's transfers. If one of them was running, the next transfer in the queue starts now.
void Udma::clear(std::size_t channel, Picoseconds now) {
  auto& queue = queues_[kChannelRows[channel].line];
  const bool runs = !queue.empty() && queue.front().channel == channel;
  if (runs) peripheral(channel).cancel(queue.front(), now);
  std::erase_if(queue, [&](const UdmaTransfer& transfer) { return transfer.channel == channel; });
  if (runs && !queue.empty()) queue.front().done_at = peripheral(queue.front().channel).end_time(queue.front(), now);
}

void Udma::enqueue(std::size_t channel, Picoseconds now) {
  if (queued(channel) >= kMostInQueue) {
    host_.host.complain(
        fmt::format("{}: a third transfer of the channel at 0x{:08x} is lost: check bit 5 of its CFG first",
                    host_.entry.name, host_.entry.base + kChannelRows[channel].offset));
    return;
  }
  auto& queue = queues_[kChannelRows[channel].line];
  queue.push_back(
      {channels_[channel].address, channels_[channel].size, outside_, static_cast<std::uint32_t>(channel), 0});
  if (queue.size() == 1) queue.front().done_at = peripheral(channel).end_time(queue.front(), now);
}

/// Computes the ends of waiting transfers again. Must be called after an event that may end such a wait.
void Udma::retry_waiting_transfers(Picoseconds now) {
  for (auto& queue : queues_) {
    if (queue.empty() || queue.front().done_at != kNever) continue;
    queue.front().done_at = peripheral(queue.front().channel).end_time(queue.front(), now);
  }
}

Picoseconds Udma::next_event() const {
  auto next = std::min(sensor_.next_event(), camera_.next_event());
  for (const auto& queue : queues_) {
    if (!queue.empty()) next = std::min(next, queue.front().done_at);
  }
  return next;
}

void Udma::advance(Picoseconds now) {
  for (auto at = next_event(); at <= now; at = next_event()) {
    if (at >= std::min(sensor_.next_event(), camera_.next_event())) {
      sensor_.advance(at);
      camera_.advance(at);
      retry_waiting_transfers(at);
    }
    for (auto& queue : queues_) {
      if (queue.empty() || at < queue.front().done_at) continue;
      const auto transfer = queue.front();
      queue.erase(queue.begin());
      peripheral(transfer.channel).end(transfer);
      host_.signals.raise_soc_event(kChannelRows[transfer.channel].event, now);
      if (!queue.empty()) {
        queue.front().done_at = peripheral(queue.front().channel).end_time(queue.front(), transfer.done_at);
      }
      retry_waiting_transfers(transfer.done_at);
    }
  }
}

const double* Udma::output(std::string_view variable) const {
  for (const auto& spim : spim_) {
    if (const auto* found = spim.output(variable)) return found;
  }
  return camera_.output(variable);
}

/// Loads the image that the parameter flash.image names into the flash.
void Udma::load_flash() {
  const auto refuse = [this](std::string_view why) {
    throw Error(fmt::format("flash.image = \"{}\": {}", flash_path_, why));
  };
  std::error_code error;
  const std::filesystem::path path(flash_path_);
  std::ifstream file(path, std::ios::binary);
  if (!file || !std::filesystem::is_regular_file(path, error)) refuse("this is not a readable file");
  std::vector<std::uint8_t> image(std::istreambuf_iterator<char>(file), {});
  if (image.size() > kFlashBytes) {
    refuse(fmt::format("the image has {} bytes, the flash of device {} holds {}", image.size(), host_.entry.name,
                       kFlashBytes));
  }
  flash_image_ = std::move(image);
  hyper_bus_.set_flash(flash_image_);
  loaded_ = flash_path_;
}

void Udma::begin_step(Picoseconds now) {
  if (!flash_path_.empty() && flash_path_ != loaded_) load_flash();
  camera_.begin_step(now);
  retry_waiting_transfers(now);
}

void Udma::visit(state::Visitor& v) {
  v("registers", host_.registers);
  v("sensor", sensor_);
  v("hyper_bus", hyper_bus_);
  v("uart", uart_);
  v("i2c", i2c_);
  v("spim", spim_);
  v("camera", camera_);
  v("channels", channels_);
  v("queues", queues_);
  v("outside", outside_);
  for (std::size_t line = 0; line < queues_.size(); ++line) {
    for (const auto& transfer : queues_[line]) {
      if (transfer.channel >= kChannelRows.size() || kChannelRows[transfer.channel].line != line) {
        throw Error(ErrorCode::state_damaged, "a saved state is damaged: a transfer is of no channel");
      }
    }
  }
}

}  // namespace mebots::soc::gap8_devices

MEBOTS_CHIP_KIND(gap8_udma, {}, [](const BoardDevice& entry, ChipHost& host) -> std::unique_ptr<Device> {
  const auto image = host.flash();
  if (image.size() > gap8_devices::Udma::kFlashBytes) {
    throw Error(fmt::format("the flash image has {} bytes, the flash of device {} holds {}", image.size(), entry.name,
                            gap8_devices::Udma::kFlashBytes));
  }
  return std::make_unique<gap8_devices::Udma>(
      entry, host, host.signals(), image, host.pictures(), [&host] { return host.clock_hz(); },
      gap8_devices::UdmaParts{
          {host.part_at(entry, "hyper_ram"), host.part_at(entry, "hyper_flash"), host.part_at(entry, "hyper_pads")},
          host.part_at(entry, "camera")});
})
