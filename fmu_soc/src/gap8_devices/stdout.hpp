// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "devices/console.hpp"

#include <cstdint>

namespace mebots::soc::gap8_devices {

/// The simulators' character output of PULP chips: a byte or word stored anywhere in it is a character. Silicon has
/// nothing there; programs of GAP8's first SDK print to it when told so. Source: archi/stdout.
class Stdout final : public Device {
 public:
  explicit Stdout(DeviceHost& host) : line_(host) {}

  bool load(std::uint32_t /*offset*/, Picoseconds /*now*/, std::uint32_t& value) override {
    value = 0;
    return true;
  }
  bool store(std::uint32_t /*offset*/, Picoseconds now, std::uint32_t value) override { return line_.put(value, now); }
  bool store_narrow(std::uint32_t offset, Picoseconds now, std::uint32_t value, unsigned /*size*/) override {
    return store(offset, now, value);
  }
  void program_ended() override { line_.program_ended(); }
  void visit(state::Visitor& v) override { line_.visit(v); }

 private:
  Console line_;
};

}  // namespace mebots::soc::gap8_devices
