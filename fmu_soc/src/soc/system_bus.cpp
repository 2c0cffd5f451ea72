// SPDX-License-Identifier: Apache-2.0
#include "soc/system_bus.hpp"

#include "hart/csr_numbers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>
#include <string_view>

namespace mebots::soc {
namespace {

/// Lowest address of the devices that all cores share. Below it, each core accesses its own registers.
constexpr std::uint32_t kSharedDevices = 0x1000'0000;

/// Address ranges of peripherals. The fabric controller's own peripherals have two ranges. Source:
/// archi/chips/gap/memory_map.h.
struct Area {
  std::uint32_t base;
  std::uint32_t size;
};
constexpr std::array<Area, 3> kAreas{{{0x1A10'0000, 0x2'0000}, {0x0020'0000, 0x5000}, {0x1B20'0000, 0x5000}}};

constexpr std::string_view kMtimerKind = "aclint_mtimer";
constexpr std::uint32_t kMtime = 0x7ff8;  // offsets in such a device
constexpr std::uint32_t kMtimeHigh = 0x7ffc;

/// Executes the CSR instruction at the pc if the board has a timer of the platform and the instruction reads `time` or
/// `timeh`, or accesses `satp`. `time` shows MTIME. `satp` reads 0 and ignores writes, as in a core without address
/// translation. It exists because programs clear it at their start. Returns false for other instructions, and in U
/// mode. Source: RISC-V Privileged Specification 20211203, sections 3.2.1 and 4.1.11.
bool serves_platform_register(Hardware& hardware, const DeviceSet& devices, Picoseconds now) {
  constexpr std::uint32_t kSystem = 0x73;
  constexpr std::uint32_t kTime = 0xc01;
  constexpr std::uint32_t kTimeHigh = 0xc81;
  constexpr std::uint32_t kSatp = 0x180;
  const auto& entries = hardware.board().devices;
  const auto entry = std::ranges::find(entries, kMtimerKind, &BoardDevice::kind);
  std::uint32_t word = 0;
  auto& hart = hardware.controller();
  const auto bytes = std::span(reinterpret_cast<std::uint8_t*>(&word), sizeof word);
  if (entry == entries.end() || !hardware.memory().read(hart.pc(), bytes)) return false;
  const auto number = word >> 20;
  const auto function = word >> 12 & 7U;
  const bool is_access = (function & 3U) != 0;
  const bool is_read = (function & 2U) != 0 && (word >> 15 & 31U) == 0;  // csrrs and csrrc that change no bit
  const bool is_time = is_read && (number == kTime || number == kTimeHigh);
  if (hart.mode() != Mode::machine) return false;  // mcounteren.TM is 0
  if ((word & 0x7fU) != kSystem || !(is_time || (is_access && number == kSatp))) return false;
  std::uint32_t value = 0;
  if (is_time) devices.find(entry->name)->load(number == kTime ? kMtime : kMtimeHigh, now, value);
  hart.set_reg(word >> 7 & 31U, value);
  return true;
}

}  // namespace

bool UnmodelledRegisters::are_at(std::uint32_t address) {
  return std::ranges::any_of(kAreas, [&](const Area& area) { return address - area.base < area.size; });
}

bool UnmodelledRegisters::is_new(std::uint32_t address) {
  return warned_.insert(address).second;
}

std::string UnmodelledRegisters::text(std::uint32_t address, bool stores, std::string_view function,
                                      const BoardDevice* entry) const {
  const auto what =
      entry == nullptr
          ? std::string("the board has no device there. Add one to the board file, described or with a kind in C++")
          : fmt::format(
                "device {} of kind {} has no such register. Add it to the kind's C++, or describe the device in the "
                "board file",
                entry->name, entry->kind);
  return fmt::format("{} 0x{:08x}{}{} {}: {}", stores ? "store into" : "load from", address,
                     function.empty() ? "" : " in ", function, stores ? "is lost" : "reads 0", what);
}

/// Returns true if an access of the fabric controller must wait, because it accesses the cluster's registers or a
/// device that sets power, and the cluster has not reached the same time.
bool SystemBus::must_wait(std::uint32_t address, Picoseconds now) const {
  const auto* cluster = hardware_.cluster();
  if (timeline_.next_of(cluster) >= now) return false;
  if (cluster->owns(address)) return true;
  const auto* slot = devices_.slot_at(address);
  return slot != nullptr && slot->sets_power;
}

BusReply SystemBus::load_quietly(std::uint32_t address, std::uint64_t cycle, unsigned size) noexcept {
  const auto* slot = devices_.slot_at(address);
  if (slot == nullptr || listens_ || !slot->device->load_is_quiet(address - slot->base)) return {};
  const auto now = timeline_.clock().time_of(cycle);
  if (must_wait(address, now)) return {};
  auto reply = BusReply::done(0, hardware_.chip().interconnect.fabric_controller_to_device);
  reply.is_quiet = true;
  const auto offset = address - slot->base;
  const bool loaded = size == 4 ? slot->device->load(offset, now, reply.value)
                                : slot->device->load_narrow(offset, now, reply.value, size);
  return loaded ? reply : BusReply{};
}

BusReply SystemBus::load(std::uint32_t address, std::uint64_t cycle) {
  devices_.touch();
  auto* cluster = hardware_.cluster();
  const auto now = timeline_.clock().time_of(cycle);
  if (must_wait(address, now)) return {BusReply::Kind::later};
  if (cluster != nullptr && cluster->owns(address)) {
    auto reply = cluster->load(address, now);
    reply.wait_cycles += hardware_.chip().interconnect.fabric_controller_to_cluster;
    return reply;
  }
  const auto* slot = devices_.slot_at(address);
  std::uint32_t value = 0;
  if (slot == nullptr || !slot->device->load(address - slot->base, now, value)) return unmodelled(address, false, true);
  return BusReply::done(value, hardware_.chip().interconnect.fabric_controller_to_device);
}

BusReply SystemBus::load_event(std::uint32_t address, std::uint64_t cycle) {
  devices_.touch();
  auto* cluster = hardware_.cluster();
  const auto now = timeline_.clock().time_of(cycle);
  if (const auto* slot = devices_.slot_at(address);
      devices_.event_unit() != nullptr && slot != nullptr &&
      dynamic_cast<gap8_devices::EventUnitDemux*>(slot->device) != nullptr) {
    return devices_.event_unit()->load_event(address - slot->base);
  }
  if (cluster == nullptr || !cluster->owns(address)) return load(address, cycle);
  if (must_wait(address, now)) return {BusReply::Kind::later};
  auto reply = cluster->load_event(address, now);
  reply.wait_cycles += hardware_.chip().interconnect.fabric_controller_to_cluster;
  return reply;
}

BusReply SystemBus::store(std::uint32_t address, std::uint64_t cycle, std::uint32_t value) {
  devices_.touch();
  auto* cluster = hardware_.cluster();
  const auto now = timeline_.clock().time_of(cycle);
  if (must_wait(address, now)) return {BusReply::Kind::later};
  if (cluster != nullptr && cluster->owns(address)) {
    auto reply = cluster->store(address, now, value);
    reply.wait_cycles += hardware_.chip().interconnect.fabric_controller_to_cluster;
    return reply;
  }
  const auto* slot = devices_.slot_at(address);
  if (slot == nullptr || !slot->device->store(address - slot->base, now, value)) return unmodelled(address, true, true);
  return BusReply::done(0, hardware_.chip().interconnect.fabric_controller_to_device);
}

BusReply SystemBus::load_narrow(std::uint32_t address, std::uint64_t cycle, unsigned size) {
  devices_.touch();
  const auto* slot = devices_.slot_at(address);
  const auto offset = slot == nullptr ? 0 : address - slot->base;
  std::uint32_t value = 0;
  if (slot == nullptr || !slot->device->load_narrow(offset, timeline_.clock().time_of(cycle), value, size)) {
    return unmodelled(address, false, true);
  }
  return BusReply::done(value, hardware_.chip().interconnect.fabric_controller_to_device);
}

BusReply SystemBus::store_narrow(std::uint32_t address, std::uint64_t cycle, std::uint32_t value, unsigned size) {
  devices_.touch();
  const auto* slot = devices_.slot_at(address);
  const auto offset = slot == nullptr ? 0 : address - slot->base;
  if (slot == nullptr || !slot->device->store_narrow(offset, timeline_.clock().time_of(cycle), value, size)) {
    return unmodelled(address, true, true);
  }
  return BusReply::done(0, hardware_.chip().interconnect.fabric_controller_to_device);
}

bool SystemBus::called_host(std::uint32_t cause) {
  if (cause == cause::kBreakpoint) return program_host_.serve_semihosting();
  if (cause == cause::kIllegalInstruction) return serves_platform_register(hardware_, devices_, timeline_.core_time());
  return (cause == cause::kMachineEcall || cause == cause::kUserEcall) && program_host_.serve_environment_call();
}

BusReply SystemBus::from_cluster(const ClusterAccess& access, Picoseconds time) {
  devices_.touch();
  const auto now = timeline_.asleep() ? time : std::max(time, timeline_.core_time());
  const auto* slot = devices_.slot_at(access.address);
  if (access.address < kSharedDevices) return {};
  if (slot == nullptr) return unmodelled(access.address, access.stored != nullptr, false);
  const auto offset = access.address - slot->base;
  const auto wait =
      hardware_.chip().interconnect.cluster_to_soc + hardware_.chip().interconnect.fabric_controller_to_device;
  if (access.stored != nullptr) {
    const bool had_ended = devices_.signals().exit_code.has_value();
    const bool stored = access.size == 4 ? slot->device->store(offset, now, *access.stored)
                                         : slot->device->store_narrow(offset, now, *access.stored, access.size);
    if (!had_ended && devices_.signals().exit_code) timeline_.set_ended_by(access.who);
    return stored ? BusReply::done(0, wait) : unmodelled(access.address, true, false);
  }
  std::uint32_t value = 0;
  return slot->device->load(offset, now, value) ? BusReply::done(value, wait)
                                                : unmodelled(access.address, false, false);
}

/// Handles an access to registers that the board does not model. It takes as long as an access to a device.
BusReply SystemBus::unmodelled(std::uint32_t address, bool stores, bool by_fabric_controller) {
  if (devices_.event_unit() == nullptr || !UnmodelledRegisters::are_at(address)) return {};
  if (unmodelled_.is_new(address) && report_) {
    const auto* slot = devices_.slot_at(address);
    const auto found = slot == nullptr ? hardware_.board().devices.end()
                                       : std::ranges::find(hardware_.board().devices, slot->name, &BoardDevice::name);
    const auto* entry = found == hardware_.board().devices.end() ? nullptr : &*found;
    const auto function = by_fabric_controller ? program_host_.function() : std::string("a core of the cluster");
    report_(unmodelled_.text(address, stores, function, entry));
  }
  const auto way = by_fabric_controller ? 0 : hardware_.chip().interconnect.cluster_to_soc;
  return BusReply::done(0, way + hardware_.chip().interconnect.fabric_controller_to_device);
}

}  // namespace mebots::soc
