// SPDX-License-Identifier: Apache-2.0
#include "devices/core/kinds.hpp"
#include "mebots/soc/device.hpp"

namespace mebots::soc {
namespace {

/// Models the software interrupt of machine mode: bit 0 of register MSIP is the level of the interrupt line. Registers
/// of missing harts read 0. Source: RISC-V Advanced Core Local Interruptor Specification 1.0-rc4, chapter
/// "Machine-level software interrupt device"; the first part of a SiFive CLINT.
class Mswi final : public Device {
 public:
  bool load(std::uint32_t offset, Picoseconds /*now*/, std::uint32_t& value) override {
    value = offset == kFirstHart ? pending_ : 0;
    return true;
  }
  bool store(std::uint32_t offset, Picoseconds /*now*/, std::uint32_t value) override {
    if (offset == kFirstHart) pending_ = value & 1U;
    return true;
  }
  bool load_is_quiet(std::uint32_t /*offset*/) const override { return true; }
  bool interrupt() const override { return pending_ != 0; }
  void visit(state::Visitor& v) override { v("pending", pending_); }

 private:
  static constexpr std::uint32_t kFirstHart = 0;

  std::uint32_t pending_ = 0;
};

}  // namespace
}  // namespace mebots::soc

MEBOTS_CHIP_KIND(aclint_mswi, {}, [](const BoardDevice& /*entry*/, ChipHost& /*host*/) -> std::unique_ptr<Device> {
  return std::make_unique<Mswi>();
})
