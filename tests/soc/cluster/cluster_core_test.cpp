// SPDX-License-Identifier: Apache-2.0
// Tests the order of accesses to shared devices, with a cluster core that has no cluster.
#include "assembler.hpp"
#include "cluster/core.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace mebots::soc::test {
namespace {

constexpr std::uint32_t kRam = 0x80000000;
constexpr std::uint32_t kDevice = 0x00204000;

/// The program loads the device's first word. Its interrupt handler loads the second word.
constexpr const char* kProgram = R"(
    .option norvc
vectors: .rept 32
    j handler
    .endr
    .globl _start
_start: li s0, 0x00204000
    csrsi mstatus, 8
    lw a0, 0(s0)
1:  j 1b
handler: .rept 20
    nop
    .endr
    lw a1, 4(s0)
2:  j 2b
)";

class LoneClusterCore : public testing::Test, private ClusterBus {
 protected:
  LoneClusterCore() {
    const auto program = assemble(kProgram);
    for (const auto& segment : program.segments()) memory_.write(segment.load_address, segment.bytes);
    core.start(program.entry(), 100);
  }

  Stop run() {
    const auto stop = core.run(core.tick() + 1000);
    core.stopped(stop);
    return stop;
  }

  static Memory make_memory() {
    Memory memory;
    memory.add("ram", kRam, 4096);
    return memory;
  }

  static ClusterSettings make_settings() {
    ClusterSettings settings;
    settings.cores = 1;
    settings.ports = {MemoryPort{}};
    settings.has_gap8_interrupts = true;
    return settings;
  }

  std::vector<std::uint32_t> accessed;

 private:
  bool permits_at_once(std::uint64_t /*tick*/) override { return false; }
  BusReply access(const ClusterAccess& access) override {
    accessed.push_back(access.address);
    return BusReply::done();
  }
  std::uint32_t interrupt_taken(unsigned /*core*/, unsigned /*line*/) override { return 0; }
  bool watched(std::uint32_t /*address*/) override { return false; }

  Memory memory_ = make_memory();
  Banks banks_{16};
  Banks soc_port_{1};
  DecodedCode code_{memory_, {.loose_limit = true, .banks = &banks_}};
  ClusterSettings settings_ = make_settings();

 protected:
  ClusterCore core{*this, settings_, 0, memory_, code_, soc_port_};
};

TEST_F(LoneClusterCore, StopsBeforeADeviceUntilItsTurn) {
  EXPECT_EQ(run(), Stop::turn);
  EXPECT_TRUE(core.waits_for_turn());
  EXPECT_TRUE(accessed.empty());
  const auto tick = core.tick();
  core.grant_turn();
  EXPECT_EQ(run(), Stop::device);
  EXPECT_EQ(accessed, std::vector{kDevice});
  EXPECT_EQ(core.accessed(), tick);
}

TEST_F(LoneClusterCore, NeedsANewTurnAfterAnInterruptBeforeTheGrantedAccess) {
  ASSERT_EQ(run(), Stop::turn);
  core.set_interrupts(1U << 3, core.tick());
  core.grant_turn();
  EXPECT_EQ(run(), Stop::turn) << "the handler's access is a later one";
  EXPECT_TRUE(accessed.empty());
  core.grant_turn();
  EXPECT_EQ(run(), Stop::device);
  EXPECT_EQ(accessed, std::vector{kDevice + 4});
}

}  // namespace
}  // namespace mebots::soc::test
