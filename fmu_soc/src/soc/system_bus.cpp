// SPDX-License-Identifier: Apache-2.0
//
// Accesses that do not end in a memory: which device answers, what that takes, and who must wait for whom.
#include "soc/soc.hpp"

#include <algorithm>
#include <string>

namespace mebots::soc {
namespace {

/// What lies below are registers that each core has for itself.
constexpr std::uint32_t kSharedDevices = 0x1000'0000;

}  // namespace

const Soc::Slot* Soc::slot_at(std::uint32_t address) const {
  for (const auto& slot : slots_) {
    if (address >= slot.base && address - slot.base < slot.size) return &slot;
  }
  return nullptr;
}

/// Whether the cluster must come to the same time before the fabric controller touches what they share.
bool Soc::must_wait(std::uint32_t address, Picoseconds now) const {
  if (cluster_next() >= now) return false;
  if (cluster_->owns(address)) return true;
  const auto* slot = slot_at(address);
  return slot != nullptr && slot->sets_power;
}

BusReply Soc::load(std::uint32_t address, std::uint64_t cycle) {
  touch_devices();
  const auto now = clock_.time_of(cycle);
  if (must_wait(address, now)) return {BusReply::Kind::later};
  if (cluster_ && cluster_->owns(address)) {
    auto reply = cluster_->load(address, now);
    reply.wait_cycles += chip_.interconnect.fabric_controller_to_cluster;
    return reply;
  }
  const auto* slot = slot_at(address);
  std::uint32_t value = 0;
  if (slot == nullptr || !slot->device->load(address - slot->base, now, value)) return unmodelled(address, false, true);
  return BusReply::done(value, chip_.interconnect.fabric_controller_to_device);
}

BusReply Soc::load_event(std::uint32_t address, std::uint64_t cycle) {
  touch_devices();
  const auto now = clock_.time_of(cycle);
  if (const auto* slot = slot_at(address); event_unit_ != nullptr && slot != nullptr &&
                                           dynamic_cast<gap8_devices::EventUnitDemux*>(slot->device) != nullptr) {
    return event_unit_->load_event(address - slot->base);
  }
  if (!cluster_ || !cluster_->owns(address)) return load(address, cycle);
  if (must_wait(address, now)) return {BusReply::Kind::later};
  auto reply = cluster_->load_event(address, now);
  reply.wait_cycles += chip_.interconnect.fabric_controller_to_cluster;
  return reply;
}

BusReply Soc::store(std::uint32_t address, std::uint64_t cycle, std::uint32_t value) {
  touch_devices();
  const auto now = clock_.time_of(cycle);
  if (must_wait(address, now)) return {BusReply::Kind::later};
  if (cluster_ && cluster_->owns(address)) {
    auto reply = cluster_->store(address, now, value);
    reply.wait_cycles += chip_.interconnect.fabric_controller_to_cluster;
    return reply;
  }
  const auto* slot = slot_at(address);
  if (slot == nullptr || !slot->device->store(address - slot->base, now, value)) return unmodelled(address, true, true);
  return BusReply::done(0, chip_.interconnect.fabric_controller_to_device);
}

BusReply Soc::load_narrow(std::uint32_t address, std::uint64_t cycle, unsigned size) {
  touch_devices();
  const auto* slot = slot_at(address);
  const auto offset = slot == nullptr ? 0 : address - slot->base;
  std::uint32_t value = 0;
  if (slot == nullptr || !slot->device->load_narrow(offset, clock_.time_of(cycle), value, size)) {
    return unmodelled(address, false, true);
  }
  return BusReply::done(value, chip_.interconnect.fabric_controller_to_device);
}

BusReply Soc::store_narrow(std::uint32_t address, std::uint64_t cycle, std::uint32_t value, unsigned size) {
  touch_devices();
  const auto* slot = slot_at(address);
  const auto offset = slot == nullptr ? 0 : address - slot->base;
  if (slot == nullptr || !slot->device->store_narrow(offset, clock_.time_of(cycle), value, size)) {
    return unmodelled(address, true, true);
  }
  return BusReply::done(0, chip_.interconnect.fabric_controller_to_device);
}

/// A cluster core reaches a device of the SoC, which it finds as far on as the fabric controller does.
BusReply Soc::from_cluster(const ClusterAccess& access, Picoseconds time) {
  touch_devices();
  const auto now = asleep_ ? time : std::max(time, core_time());
  const auto* slot = slot_at(access.address);
  if (access.address < kSharedDevices) return {};
  if (slot == nullptr) return unmodelled(access.address, access.stored != nullptr, false);
  const auto offset = access.address - slot->base;
  const auto wait = chip_.interconnect.cluster_to_soc + chip_.interconnect.fabric_controller_to_device;
  if (access.stored != nullptr) {
    const bool had_ended = signals_.exit_code.has_value();
    const bool stored = access.size == 4 ? slot->device->store(offset, now, *access.stored)
                                         : slot->device->store_narrow(offset, now, *access.stored, access.size);
    if (!had_ended && signals_.exit_code) ended_by_ = static_cast<std::int32_t>(access.who);
    return stored ? BusReply::done(0, wait) : unmodelled(access.address, true, false);
  }
  std::uint32_t value = 0;
  return slot->device->load(offset, now, value) ? BusReply::done(value, wait)
                                                : unmodelled(access.address, false, false);
}

/// An access that nothing answers; where it goes on, it takes as long as one that something answers.
BusReply Soc::unmodelled(std::uint32_t address, bool stores, bool by_fabric_controller) {
  if (event_unit_ == nullptr || !UnmodelledRegisters::are_at(address)) return {};
  if (unmodelled_.is_new(address) && listeners_.faults) {
    const auto* slot = slot_at(address);
    const auto found =
        slot == nullptr ? board_.devices.end() : std::ranges::find(board_.devices, slot->name, &BoardDevice::name);
    const auto* entry = found == board_.devices.end() ? nullptr : &*found;
    const auto function = by_fabric_controller ? host_->function() : std::string("a core of the cluster");
    listeners_.faults(unmodelled_.text(address, stores, function, entry));
  }
  const auto way = by_fabric_controller ? 0 : chip_.interconnect.cluster_to_soc;
  return BusReply::done(0, way + chip_.interconnect.fabric_controller_to_device);
}

}  // namespace mebots::soc
