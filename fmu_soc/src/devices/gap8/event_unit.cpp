// SPDX-License-Identifier: Apache-2.0
#include "devices/gap8/event_unit.hpp"

#include "devices/core/kinds.hpp"
#include "devices/gap8/event_unit_registers.hpp"
#include "mebots/error.hpp"

#include <fmt/format.h>

#include <bit>

namespace mebots::soc::gap8_devices {
namespace {

namespace reg = event_unit_reg;

constexpr std::uint32_t kValid = 1U << 31;

}  // namespace

EventUnit::EventUnit(Signals& signals) {
  queue_.reserve(kQueue);
  signals.raise_fabric_event = [this](unsigned event) { raise(event); };
}

bool EventUnit::load(std::uint32_t offset, std::uint32_t& value) {
  switch (offset) {
    case reg::kMask:
      value = event_mask_;
      return true;
    case reg::kMaskIrq:
      value = interrupt_mask_;
      return true;
    case reg::kStatus:  // 1: the clock of the core runs, which is always true during an access
      value = 1;
      return true;
    case reg::kBuffer:
      value = buffer_;
      return true;
    case reg::kBufferMasked:
    case reg::kEventWait:
      value = buffer_ & event_mask_;
      return true;
    case reg::kBufferIrqMasked:
      value = buffer_ & interrupt_mask_;
      return true;
    case reg::kEventWaitClear:
      value = buffer_ & event_mask_;
      buffer_ &= ~value;
      refresh();
      return true;
    default:
      return false;
  }
}

bool EventUnit::store(std::uint32_t offset, std::uint32_t value) {
  switch (offset) {
    case reg::kMask:
      event_mask_ = value;
      return true;
    case reg::kMaskAnd:
      event_mask_ &= ~value;
      return true;
    case reg::kMaskOr:
      event_mask_ |= value;
      return true;
    case reg::kMaskIrq:
      interrupt_mask_ = value;
      return true;
    case reg::kMaskIrqAnd:
      interrupt_mask_ &= ~value;
      return true;
    case reg::kMaskIrqOr:
      interrupt_mask_ |= value;
      return true;
    case reg::kBufferClear:
      buffer_ &= ~value;
      refresh();
      return true;
    default:
      break;
  }
  const auto word = (offset - reg::kTriggerSoftwareEvent) / 4;
  if (offset < reg::kTriggerSoftwareEvent || word >= reg::kSoftwareEvents) return false;
  raise(word);  // the stored value selects cores, but there is only the fabric controller
  return true;
}

BusReply EventUnit::load_event(std::uint32_t offset) {
  std::uint32_t value = 0;
  const bool waits = offset == reg::kEventWait || offset == reg::kEventWaitClear;
  if (waits && (buffer_ & event_mask_) == 0) {
    waits_ = true;
    return {BusReply::Kind::blocked};
  }
  waits_ = false;
  if (!load(offset, value)) return {};
  return BusReply::done(value);
}

std::uint32_t EventUnit::take_soc_event() {
  if (queue_.empty()) return 0;
  const auto event = queue_.front();
  queue_.erase(queue_.begin());
  refresh();
  return kValid | event;
}

/// Sets event 27 while the queue of SoC events is not empty.
void EventUnit::refresh() {
  if (!queue_.empty()) buffer_ |= 1U << kSocEvent;
}

void EventUnit::raise(unsigned event) {
  buffer_ |= 1U << event;
}

void EventUnit::queue_soc_event(unsigned event) {
  if (queue_.size() < kQueue) queue_.push_back(static_cast<std::uint8_t>(event));
  refresh();
}

void EventUnit::acknowledge(unsigned line) {
  buffer_ &= ~(1U << line);
  refresh();
}

std::uint32_t EventUnit::lines() const {
  return std::bit_floor(buffer_ & interrupt_mask_);
}

bool EventUnit::take_wake() {
  if (!waits_ || (buffer_ & event_mask_) == 0) return false;
  waits_ = false;
  return true;
}

void EventUnit::visit(state::Visitor& v) {
  v("buffer", buffer_);
  v("event_mask", event_mask_);
  v("interrupt_mask", interrupt_mask_);
  v("waits", waits_);
  v("queue", queue_);
  if (queue_.size() > kQueue) throw Error(ErrorCode::state_damaged, "a saved state is damaged: too many SoC events");
}

bool EventUnitPort::load(std::uint32_t offset, Picoseconds /*now*/, std::uint32_t& value) {
  if (offset == reg::kLongSocEvents) {
    value = unit_.take_soc_event();
    return true;
  }
  return offset < reg::kLongSoftwareEvents && unit_.load(offset, value);
}

bool EventUnitPort::store(std::uint32_t offset, Picoseconds /*now*/, std::uint32_t value) {
  if (offset >= reg::kLongSoftwareEvents)
    return unit_.store(offset - reg::kLongSoftwareEvents + reg::kTriggerSoftwareEvent, value);
  return offset < reg::kTriggerSoftwareEvent && unit_.store(offset, value);
}

EventUnit& event_unit_before(const BoardDevice& entry, const DeviceSource& devices) {
  if (auto* port = devices.find<EventUnitPort>()) return port->unit();
  throw Error(fmt::format("board: device {} of kind {} needs a device of kind {} earlier in the file", entry.name,
                          entry.kind, kGap8EventUnitKind));
}

}  // namespace mebots::soc::gap8_devices

MEBOTS_CHIP_KIND(gap8_event_unit, {}, [](const BoardDevice& /*entry*/, ChipHost& host) -> std::unique_ptr<Device> {
  return std::make_unique<gap8_devices::EventUnitPort>(host.signals());
})
MEBOTS_CHIP_KIND(gap8_event_unit_demux, {}, [](const BoardDevice& entry, ChipHost& host) -> std::unique_ptr<Device> {
  return std::make_unique<gap8_devices::EventUnitDemux>(gap8_devices::event_unit_before(entry, host));
})
