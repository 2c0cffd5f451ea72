// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cluster/peripherals.hpp"
#include "devices/gap8/cluster_event_unit.hpp"
#include "devices/gap8/mchan.hpp"
#include "devices/gap8/timer.hpp"
#include "mebots/soc/device_kind.hpp"

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace mebots::soc::gap8_devices {

/// Models the registers of GAP8's cluster, from 0x10200000 on: control unit (boot addresses, fetch enable), timer,
/// event unit, control of the instruction cache, DMA. A core can also access them at 0x00200000. At offsets 0x4000 and
/// 0x4400, a core accesses its own registers of event unit and DMA. A register that is not modelled is reported once,
/// and reads 0.
///
/// A word of L1 has a second address, 1 MiB above, for test-and-set: a load returns the word and sets all its bits, so
/// that only one core gets a lock. Sources: archi/chips/gap/memory_map.h, properties.h (ARCHI_L1_TAS_BIT),
/// archi/cluster_ctrl/cluster_ctrl_v2.h.
class ClusterPeripherals final : public soc::ClusterPeripherals {
 public:
  struct Parts {
    unsigned cores = 0;
    Mchan::L1 l1;
    ClusterDma* dma = nullptr;
  };

  ClusterPeripherals(const BoardDevice& entry, DeviceHost& host, const Parts& parts);

  bool owns_of_core(std::uint32_t address) const override;
  bool owns_of_fabric_controller(std::uint32_t address) const override;
  BusReply access(const ClusterAccess& access) override;
  std::uint64_t next_tick() const override { return timer_.next_tick(); }
  void advance(std::uint64_t tick) override { timer_.advance(tick); }
  void transfer_ended(unsigned who, std::uint32_t tag, std::uint64_t tick) override;

  void reset(std::uint32_t boot) override;
  std::uint32_t take_started() override;
  /// Returns the address of a core's first instruction, which is 0x80 bytes after the start of the core's interrupt
  /// vectors. Source: RI5CY's user manual of 2018, instruction fetch.
  std::uint32_t boot_address(unsigned core) const override { return (boot_[core] & ~0xffU) + 0x80U; }
  std::uint32_t take_woken() override { return events_.take_woken(); }
  std::uint32_t take_line_changes() override { return events_.take_line_changes(); }
  std::uint32_t lines(unsigned core) const override { return events_.lines(core); }
  void interrupt_taken(unsigned core, unsigned line) override { events_.interrupt_taken(core, line); }

  void visit(state::Visitor& v) override;

 private:
  BusReply access_at(std::uint32_t offset, const ClusterAccess& access);
  BusReply control(std::uint32_t offset, const std::uint32_t* stored);
  BusReply timer(std::uint32_t offset, const ClusterAccess& access);
  bool is_test_and_set(std::uint32_t address) const;
  BusReply test_and_set(std::uint32_t address, const std::uint32_t* stored);
  BusReply pass_over(std::uint32_t offset, const ClusterAccess& access);
  void warn_once(std::uint32_t offset, const ClusterAccess& access, std::string_view what);

  const BoardDevice& entry_;
  DeviceHost& host_;
  Mchan::L1 l1_;
  unsigned cores_;
  ClusterEventUnit events_;
  Mchan mchan_;
  ClusterTimer timer_;
  std::array<std::uint32_t, kMostClusterCores> boot_{};
  std::uint32_t fetching_ = 0;  // cores whose fetch is enabled
  std::uint32_t started_ = 0;   // cores that the present access starts; cleared by take_started()
  /// Reported offsets of registers that are not modelled. Not part of a saved state.
  std::vector<std::uint32_t> warned_;
};

}  // namespace mebots::soc::gap8_devices
