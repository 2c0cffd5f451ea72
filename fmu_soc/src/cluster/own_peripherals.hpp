// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cluster/dma.hpp"
#include "cluster/event_unit.hpp"
#include "cluster/peripherals.hpp"

#include <cstdint>

namespace mebots::soc {

/// Registers of MEbots' own event unit and DMA. All cores start when the cluster is switched on.
class OwnPeripherals final : public ClusterPeripherals {
 public:
  OwnPeripherals(unsigned cores, std::uint32_t event_unit_base, std::uint32_t dma_base, ClusterDma& dma)
      : cores_(cores), event_unit_base_(event_unit_base), dma_base_(dma_base), event_unit_(cores), dma_(dma) {}

  bool owns_of_core(std::uint32_t address) const override { return owns(address); }
  bool owns_of_fabric_controller(std::uint32_t address) const override { return owns(address); }
  BusReply access(const ClusterAccess& access) override;
  void transfer_ended(unsigned who, std::uint32_t /*tag*/, std::uint64_t /*tick*/) override {
    event_unit_.raise(1U << who, event::kDmaDone);
  }

  void reset(std::uint32_t boot) override;
  std::uint32_t take_started() override;
  std::uint32_t boot_address(unsigned /*core*/) const override { return boot_; }
  std::uint32_t take_woken() override { return event_unit_.take_woken(); }
  bool interrupt() const override { return event_unit_.interrupt(); }

  void visit(state::Visitor& v) override;

 private:
  bool owns(std::uint32_t address) const;

  unsigned cores_;
  std::uint32_t event_unit_base_;
  std::uint32_t dma_base_;
  EventUnit event_unit_;
  ClusterDma& dma_;
  std::uint32_t boot_ = 0;     // not part of a state, because it is only used during power_on()
  std::uint32_t started_ = 0;  // not part of a state, because it is only used during power_on()
};

}  // namespace mebots::soc
