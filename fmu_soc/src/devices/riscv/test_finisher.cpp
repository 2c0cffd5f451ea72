// SPDX-License-Identifier: Apache-2.0
#include "devices/core/kinds.hpp"
#include "mebots/soc/device.hpp"

#include <fmt/format.h>

namespace mebots::soc {
namespace {

/// Models SiFive's test finisher: a store of pass, fail or reset into bits 15 to 0 of its register ends the program.
/// Bits 31 to 16 are the exit code of a failure. Source: QEMU 7.2, hw/misc/sifive_test.c; SiFive FU540-C000 device
/// tree, "sifive,test0".
class TestFinisher final : public Device {
 public:
  TestFinisher(DeviceHost& host, ProgramEnd& end) : host_(host), end_(end) {}

  bool load(std::uint32_t /*offset*/, Picoseconds /*now*/, std::uint32_t& value) override {
    value = 0;
    return true;
  }
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override {
    return store_narrow(offset, now, value, 4);
  }
  bool store_narrow(std::uint32_t offset, Picoseconds /*now*/, std::uint32_t value, unsigned size) override;
  void visit(state::Visitor& /*v*/) override {}

 private:
  static constexpr std::uint32_t kFail = 0x3333;
  static constexpr std::uint32_t kPass = 0x5555;
  static constexpr std::uint32_t kReset = 0x7777;
  // Exit code of a reset, which is also the exit code of a fault.
  static constexpr std::int32_t kResetCode = 101;

  DeviceHost& host_;
  ProgramEnd& end_;
};

bool TestFinisher::store_narrow(std::uint32_t offset, Picoseconds /*now*/, std::uint32_t value, unsigned size) {
  if (offset != 0 || size == 1) return offset < 4;
  switch (value & 0xffffU) {
    case kPass:
      end_.end_program(0);
      break;
    case kFail:
      end_.end_program(size == 4 ? static_cast<std::int32_t>(value >> 16) : 0);
      break;
    case kReset:
      host_.complain(
          "the program requested a reset from the test finisher (0x7777), which is not modelled: the run ends");
      end_.end_program(kResetCode);
      break;
    default:
      host_.complain(
          fmt::format("the test finisher ignores 0x{:08x}: 0x5555 ends the program with exit code 0, 0x3333 "
                      "with the code in bits 31 to 16",
                      value));
      break;
  }
  return true;
}

}  // namespace
}  // namespace mebots::soc

MEBOTS_CHIP_KIND(sifive_test, {}, [](const BoardDevice& /*entry*/, ChipHost& host) -> std::unique_ptr<Device> {
  return std::make_unique<TestFinisher>(host, host);
})
