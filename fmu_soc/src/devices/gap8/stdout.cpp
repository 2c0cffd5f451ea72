// SPDX-License-Identifier: Apache-2.0
#include "devices/core/kinds.hpp"
#include "devices/generic/console.hpp"

#include <cstdint>

namespace mebots::soc::gap8_devices {
namespace {

/// Models the character output of PULP simulators, which silicon does not have. A byte or word that is stored anywhere
/// in its range is a character. Source: archi/stdout.
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

}  // namespace
}  // namespace mebots::soc::gap8_devices

MEBOTS_CHIP_KIND(gap8_stdout, {}, [](const BoardDevice& /*entry*/, ChipHost& host) -> std::unique_ptr<Device> {
  return std::make_unique<gap8_devices::Stdout>(host);
})
