// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/soc/device_kind.hpp"

#include <array>
#include <cstdint>

namespace mebots::soc::gap8_devices {

/// GAP8's fuses: 128 registers of eight bits, blank at the start, in which a bit that is programmed stays 1. A command
/// says first what follows: reading, programming, or sleep. A store into a register while programming names one bit
/// of it. The time that a bit takes is not modelled. Source: archi/efuse/efuse_v1.h, hal/efuse/efuse_v1.h.
class Efuse final : public Device {
 public:
  static constexpr std::size_t kFuses = 128;

  Efuse(const BoardDevice& entry, DeviceHost& host) : entry_(entry), host_(host) {}

  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override;
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override;
  bool load_narrow(std::uint32_t offset, Picoseconds now, std::uint32_t& value, unsigned size) override;
  bool store_narrow(std::uint32_t offset, Picoseconds now, std::uint32_t value, unsigned size) override;
  void visit(state::Visitor& v) override {
    v("command", command_);
    v("timings", timings_);
    v("fuses", fuses_);
  }

 private:
  static constexpr std::uint32_t kRead = 1;
  static constexpr std::uint32_t kProgram = 2;
  static constexpr std::uint32_t kSleep = 4;

  const BoardDevice& entry_;
  DeviceHost& host_;
  std::uint32_t command_ = kSleep;
  std::uint32_t timings_ = 0;
  std::array<std::uint8_t, kFuses> fuses_{};
};

}  // namespace mebots::soc::gap8_devices
