// SPDX-License-Identifier: Apache-2.0
#include "devices/gap8/soc_events.hpp"

#include "devices/core/kinds.hpp"
#include "devices/gap8/event_unit.hpp"

#include <utility>

namespace mebots::soc::gap8_devices {
namespace {

constexpr std::uint32_t kEvent = 0x00;
constexpr std::uint32_t kFirstMask = 0x04;
constexpr unsigned kSoftwareTriggers = 8;

}  // namespace

SocEvents::SocEvents(Signals& signals, Deliver deliver) : deliver_(std::move(deliver)) {
  masks_.fill(0xffffffffU);
  signals.raise_soc_event = [this](unsigned event, Picoseconds /*now*/) { raise(event); };
}

bool SocEvents::load(std::uint32_t offset, Picoseconds /*now*/, std::uint32_t& value) {
  const auto index = (offset - kFirstMask) / 4;
  if (offset < kFirstMask || index >= kMasks) return false;
  value = masks_[index];
  return true;
}

bool SocEvents::store(std::uint32_t offset, Picoseconds now, std::uint32_t value) {
  if (offset == kEvent) {
    for (unsigned event = 0; event < kSoftwareTriggers; ++event) {
      if ((value >> event & 1U) != 0) raise(kFirstSoftwareEvent + event);
    }
    return true;
  }
  const auto index = (offset - kFirstMask) / 4;
  if (index >= kMasks) return false;
  masks_[index] = value;
  // An edge that occurred while its event was masked raises no event later.
  edges_ = reference_edges(now);
  return true;
}

void SocEvents::advance(Picoseconds now) {
  const auto edges = reference_edges(now);
  if (edges > edges_ && is_unmasked(kReferenceClockEvent)) deliver_(kReferenceClockEvent);
  edges_ = edges;
}

Picoseconds SocEvents::next_event() const {
  return is_unmasked(kReferenceClockEvent) ? reference_edge_time(edges_ + 1) : kNever;
}

void SocEvents::visit(state::Visitor& v) {
  v("masks", masks_);
  v("edges", edges_);
}

}  // namespace mebots::soc::gap8_devices

MEBOTS_CHIP_KIND(gap8_soc_events, {}, [](const BoardDevice& entry, ChipHost& host) -> std::unique_ptr<Device> {
  auto& unit = gap8_devices::event_unit_before(entry, host);
  return std::make_unique<gap8_devices::SocEvents>(host.signals(),
                                                   [&unit](unsigned event) { unit.queue_soc_event(event); });
})
