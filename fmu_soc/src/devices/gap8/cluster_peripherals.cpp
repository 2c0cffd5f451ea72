// SPDX-License-Identifier: Apache-2.0
#include "devices/gap8/cluster_peripherals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

namespace mebots::soc::gap8_devices {
namespace {

constexpr std::uint32_t kSpan = 0x5000;
/// Distance from the cluster's registers to the address range in which a cluster core also sees them.
constexpr std::uint32_t kAlias = 0x1000'0000;

/// Distance from a word of L1 to its test-and-set address.
constexpr std::uint32_t kTestAndSet = 1U << 20;

constexpr std::uint32_t kControlBytes = 0x400;
constexpr std::uint32_t kTimer = 0x400;
constexpr std::uint32_t kEventUnit = 0x800;
constexpr std::uint32_t kEventUnitBytes = 0x800;
constexpr std::uint32_t kCacheControl = 0x1400;
constexpr std::uint32_t kCacheControlBytes = 0x10;
constexpr std::uint32_t kDma = 0x1800;
constexpr std::uint32_t kDmaBytes = 0x8;
constexpr std::uint32_t kEventUnitShort = 0x4000;
constexpr std::uint32_t kEventUnitShortBytes = 0x400;
constexpr std::uint32_t kDmaShort = 0x4400;

constexpr std::uint32_t kEndOfComputation = 0x00;
constexpr std::uint32_t kFetchEnable = 0x08;
constexpr std::uint32_t kClusterConfig = 0x18;
constexpr std::uint32_t kClockGate = 0x20;
constexpr std::uint32_t kBootAddress = 0x40;

}  // namespace

ClusterPeripherals::ClusterPeripherals(const BoardDevice& entry, DeviceHost& host, const Parts& parts)
    : entry_(entry),
      host_(host),
      l1_(parts.l1),
      cores_(parts.cores),
      events_(parts.cores),
      mchan_(parts.l1, *parts.dma),
      timer_([this](unsigned counter) { events_.raise((1U << cores_) - 1, ClusterEventUnit::kTimerEvent + counter); }) {
}

bool ClusterPeripherals::owns_of_core(std::uint32_t address) const {
  return address - entry_.base < kSpan || address - (entry_.base - kAlias) < kSpan || is_test_and_set(address);
}

bool ClusterPeripherals::owns_of_fabric_controller(std::uint32_t address) const {
  return address - entry_.base < kSpan || address - (l1_.base + kTestAndSet) < l1_.size;
}

bool ClusterPeripherals::is_test_and_set(std::uint32_t address) const {
  const auto offset = address - (l1_.base + kTestAndSet);
  return offset < l1_.size || offset + kAlias < l1_.size;
}

/// Serves an access to a test-and-set address. A store to such an address is an ordinary store.
BusReply ClusterPeripherals::test_and_set(std::uint32_t address, const std::uint32_t* stored) {
  const auto offset = address - (l1_.base + kTestAndSet);
  const auto place = l1_.base + (offset < l1_.size ? offset : offset + kAlias);
  std::array<std::uint8_t, 4> bytes{};
  host_.read_memory(place, bytes);
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data(), sizeof value);
  const std::uint32_t left = stored == nullptr ? ~std::uint32_t{0} : *stored;
  std::memcpy(bytes.data(), &left, sizeof left);
  host_.write_memory(place, bytes);
  return BusReply::done(stored == nullptr ? value : 0);
}

BusReply ClusterPeripherals::access(const ClusterAccess& access) {
  if (is_test_and_set(access.address)) return test_and_set(access.address, access.stored);
  const auto offset = access.address - entry_.base;
  return access_at(offset < kSpan ? offset : offset + kAlias, access);
}

BusReply ClusterPeripherals::access_at(std::uint32_t offset, const ClusterAccess& access) {
  const bool is_core = access.who != kFabricController;
  BusReply reply;
  if (offset < kControlBytes) {
    reply = control(offset, access.stored);
  } else if (offset >= kTimer && offset < kTimer + TimerCounters::kSpan) {
    reply = timer(offset - kTimer, access);
  } else if (offset >= kEventUnit && offset < kEventUnit + kEventUnitBytes) {
    reply = events_.shared(offset - kEventUnit, access.stored);
  } else if (offset >= kCacheControl && offset < kCacheControl + kCacheControlBytes) {
    // Commands of the instruction cache have no effect, because the modelled cache is always enabled and coherent.
    reply = BusReply::done(0);
  } else if (offset >= kDma && offset < kDma + kDmaBytes) {
    return mchan_.access(access.who, offset - kDma, access.stored, access.tick);
  } else if (is_core && offset >= kEventUnitShort && offset < kEventUnitShort + kEventUnitShortBytes) {
    reply = events_.own(access.who, offset - kEventUnitShort, access.stored, access.event);
  } else if (is_core && offset >= kDmaShort && offset < kDmaShort + kDmaBytes) {
    return mchan_.access(access.who, offset - kDmaShort, access.stored, access.tick);
  }
  return reply.kind == BusReply::Kind::none ? pass_over(offset, access) : reply;
}

BusReply ClusterPeripherals::control(std::uint32_t offset, const std::uint32_t* stored) {
  const auto core = (offset - kBootAddress) / 4;
  if (offset >= kBootAddress && core < kMostClusterCores) {
    if (stored == nullptr) return BusReply::done(boot_[core]);
    boot_[core] = *stored;
    return BusReply::done();
  }
  switch (offset) {
    case kFetchEnable:
      if (stored == nullptr) return BusReply::done(fetching_);
      // A running core stops only when the cluster stops.
      started_ |= *stored & ~fetching_ & ((1U << cores_) - 1);
      fetching_ |= started_;
      return BusReply::done();
    case kEndOfComputation:
    case kClusterConfig:
    case kClockGate:
      return BusReply::done();
    default:
      return {};
  }
}

BusReply ClusterPeripherals::timer(std::uint32_t offset, const ClusterAccess& access) {
  if (access.stored == nullptr) {
    std::uint32_t value = 0;
    return timer_.load(offset, access.tick, value) ? BusReply::done(value) : BusReply{};
  }
  if (ClusterTimer::wants_reference_clock(offset, *access.stored)) {
    warn_once(kTimer + offset, access, "its reference clock is not modelled; the counter does not count");
  }
  return timer_.store(offset, access.tick, *access.stored) ? BusReply::done() : BusReply{};
}

/// Reports an access to a register that is not modelled. Only the first access to each register is reported.
BusReply ClusterPeripherals::pass_over(std::uint32_t offset, const ClusterAccess& access) {
  warn_once(offset, access, "this register, or this kind of access to it, is not modelled; it reads 0");
  return BusReply::done();
}

void ClusterPeripherals::warn_once(std::uint32_t offset, const ClusterAccess& access, std::string_view what) {
  if (std::ranges::find(warned_, offset) != warned_.end()) return;
  warned_.push_back(offset);
  const auto who = access.who == kFabricController ? std::string("the fabric controller")
                                                   : fmt::format("cluster core {}", access.who);
  host_.complain(fmt::format("{}: {} 0x{:08x} by {}: {}", entry_.name,
                             access.stored == nullptr ? "load from" : "store into", entry_.base + offset, who, what));
}

void ClusterPeripherals::transfer_ended(unsigned who, std::uint32_t tag, std::uint64_t tick) {
  const auto ended = mchan_.ended(tag, tick);
  const auto all = (1U << cores_) - 1;
  const auto cores = ended.for_all ? all : (1U << who) & all;
  if (ended.raises_event) events_.raise(cores, ClusterEventUnit::kDmaEvent);
  if (ended.raises_interrupt) events_.raise(cores, ClusterEventUnit::kDmaInterruptEvent);
}

void ClusterPeripherals::reset(std::uint32_t /*boot*/) {
  events_ = ClusterEventUnit(cores_);
  mchan_.reset();
  timer_.reset();
  boot_ = {};
  fetching_ = 0;
  started_ = 0;
}

std::uint32_t ClusterPeripherals::take_started() {
  const auto started = started_;
  started_ = 0;
  return started;
}

void ClusterPeripherals::visit(state::Visitor& v) {
  v("events", events_);
  v("mchan", mchan_);
  v("timer", timer_);
  v("boot", boot_);
  v("fetching", fetching_);
}

}  // namespace mebots::soc::gap8_devices
