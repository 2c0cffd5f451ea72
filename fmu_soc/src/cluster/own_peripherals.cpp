// SPDX-License-Identifier: Apache-2.0
#include "cluster/own_peripherals.hpp"

#include "fmu_soc_board/board.hpp"

#include <array>
#include <cstddef>

namespace mebots::soc {
namespace {

template <std::size_t Count>
constexpr std::uint32_t size_of(const std::array<board::RegisterName, Count>& registers) {
  return registers.back().offset + 4;
}

}  // namespace

bool OwnPeripherals::owns(std::uint32_t address) const {
  return address - event_unit_base_ < size_of(board::event_unit::kRegisters) ||
         address - dma_base_ < size_of(board::cluster_dma::kRegisters);
}

BusReply OwnPeripherals::access(const ClusterAccess& access) {
  const auto who = access.who;
  if (const auto offset = access.address - event_unit_base_; offset < size_of(board::event_unit::kRegisters)) {
    if (access.stored == nullptr) {
      return access.event ? event_unit_.load_event(who, offset) : event_unit_.load(who, offset);
    }
    return event_unit_.store(who, offset, *access.stored) ? BusReply::done() : BusReply{};
  }
  if (const auto offset = access.address - dma_base_; offset < size_of(board::cluster_dma::kRegisters)) {
    if (access.stored == nullptr) return dma_.load(who, offset);
    return dma_.store(who, offset, *access.stored, access.tick) ? BusReply::done() : BusReply{};
  }
  return {};
}

void OwnPeripherals::reset(std::uint32_t boot) {
  event_unit_ = EventUnit(cores_);
  boot_ = boot;
  started_ = (1U << cores_) - 1;
}

std::uint32_t OwnPeripherals::take_started() {
  const auto started = started_;
  started_ = 0;
  return started;
}

void OwnPeripherals::visit(state::Visitor& v) {
  event_unit_.visit(v);
}

}  // namespace mebots::soc
