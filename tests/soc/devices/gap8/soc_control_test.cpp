// SPDX-License-Identifier: Apache-2.0
// Tests GAP8's SoC control: end of a program, number of cores, and registers that are not modelled.
#include "gap8_system.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mebots::soc::test {
namespace {

/// Returns a program whose exceptions jump to `ends`. The fabric controller executes `rest`; cores 1 and 5 start at
/// `core`.
std::string with_handler(std::string_view rest) {
  constexpr std::string_view kVectors = R"(
    .balign 256
vectors: j ends
    .org vectors + 0x80
    j begin
    .org vectors + 0x84
    j ends
    .globl _start
_start:
begin: csrr a0, mhartid
    li a1, 0x400
    bne a0, a1, core
)";
  return fmt::format("{}{}{}", kVectors, start_cluster(0b100010), rest);
}

TEST(Gap8Cluster, NamesTheFirstCoreInTimeWhoseExceptionEndsTheProgram) {
  Gap8System system(with_handler(R"(
2:  j 2b
core: li a1, 1
    beq a0, a1, 3f
    .word 0
3:  .rept 4
    nop
    .endr
    .word 0
ends: csrr a1, mhartid
    li a2, 0x80000000
    add a2, a2, a1
    li a1, SOC_CONTROL_BASE + SOC_CONTROL_CORESTATUS_OFFSET
    sw a2, 0(a1)
4:  j 4b
)"));
  system.soc.advance(1 * kMs);
  EXPECT_EQ(system.soc.exit_code(), 5);
  EXPECT_EQ(system.soc.gave_up(), 5);
  ASSERT_EQ(system.faults.size(), 1U);
  EXPECT_THAT(system.faults.front(), testing::HasSubstr("cluster core 5: the program's own handler ended the program"));
}

TEST(Gap8Cluster, DoesNotReportACoreWhoseHandlerContinues) {
  Gap8System system(with_handler(R"(
2:  j 2b
core: li a1, 1
    beq a0, a1, 4f
    li a1, 1000
3:  addi a1, a1, -1
    bnez a1, 3b
4:  .word 0
ends: csrr a1, mhartid
    li a2, 1
    beq a1, a2, 2b
    li a1, SOC_CONTROL_BASE + SOC_CONTROL_CORESTATUS_OFFSET
    li a2, 0x80000007
    sw a2, 0(a1)
5:  j 5b
)"));
  system.soc.advance(1 * kMs);
  EXPECT_EQ(system.soc.exit_code(), 7);
  EXPECT_EQ(system.soc.gave_up(), 5);
}

TEST(Gap8Cluster, DoesNotReportACoreIfTheFabricControllerEndsTheProgramWithoutAnException) {
  Gap8System system(with_handler(R"(
    li a1, 10000
2:  addi a1, a1, -1
    bnez a1, 2b
    li a1, SOC_CONTROL_BASE + SOC_CONTROL_CORESTATUS_OFFSET
    li a2, 0x80000003
    sw a2, 0(a1)
core: .word 0
ends: j ends
)"));
  system.soc.advance(1 * kMs);
  EXPECT_EQ(system.soc.end(), End::exited);
  EXPECT_EQ(system.soc.exit_code(), 3);
  EXPECT_EQ(system.soc.gave_up(), std::nullopt);
  EXPECT_FALSE(system.soc.faulted());
  EXPECT_TRUE(system.faults.empty());
}

/// Returns a system whose core 0 loads 256 times from `base` + `offset`, stores once to it, and sleeps.
Gap8System core_that_reads(std::string_view base, std::string_view offset) {
  const auto reads = fmt::format(R"(
2:  wfi
    j 2b
core: li s1, {0}
    li a2, 256
3:  lw a0, {1}(s1)
    addi a2, a2, -1
    bnez a2, 3b
    sw a0, {1}(s1)
    li s0, EU_BASE
4:  .insn i 0x03, 6, a5, EU_WAIT_CLEAR_OFFSET(s0)
    j 4b
fault: j fault
)",
                                 base, offset);
  return Gap8System(fmt::format("{}{}{}", kBegin, start_cluster(1), reads));
}

TEST(Gap8Cluster, ContinuesAfterAnAccessWithoutADeviceWithADevicesLatency) {
  auto modelled = core_that_reads("SOC_CONTROL_BASE", "0x70");
  auto nowhere = core_that_reads("0x1A103000", "0x04");
  modelled.soc.advance(5 * kMs);
  nowhere.soc.advance(5 * kMs);
  EXPECT_TRUE(modelled.faults.empty()) << modelled.faults.front();
  ASSERT_EQ(nowhere.faults.size(), 1U);
  EXPECT_THAT(nowhere.faults[0], testing::HasSubstr("load from 0x1a103004 in a core of the cluster"));
  EXPECT_FALSE(nowhere.soc.faulted());
  EXPECT_TRUE(nowhere.soc.hart(1).sleeping());
  EXPECT_EQ(nowhere.soc.hart(1).counters().cycles, modelled.soc.hart(1).counters().cycles);
}

TEST(Gap8Cluster, SocControlShowsTheNumberOfCores) {
  constexpr std::string_view kProgram = R"(
_start: li s0, SOC_CONTROL_BASE
    lw a0, 0(s0)
    li t0, RESULTS
    sw a0, 0(t0)
2:  j 2b
)";
  for (const auto& [cores, info] : {std::pair{8U, 0x80001U}, std::pair{1U, 0x10001U}, std::pair{0U, 0U}}) {
    Settings settings;
    settings.cluster_cores = cores;
    Gap8System system(kProgram, settings);
    system.soc.advance(1 * kMs);
    EXPECT_EQ(system.result(0), info) << cores;
  }
}

TEST(Gap8Cluster, ReportsARegisterWithoutAModelOnce) {
  Gap8System system(R"(
_start: li s0, SOC_CONTROL_BASE
    li a0, BYPASS_CLUSTER_ON
    sw a0, SOC_CONTROL_CL_BYPASS_OFFSET(s0)
    li s0, CLUSTER_BASE
    li a1, 3
1:  lw a0, 0x300(s0)
    addi a1, a1, -1
    bnez a1, 1b
2:  j 2b
)");
  system.soc.advance(1 * kMs);
  ASSERT_EQ(system.faults.size(), 1U);
  EXPECT_THAT(system.faults[0], testing::HasSubstr("cluster: load from 0x10200300 by the fabric controller"));
}

}  // namespace
}  // namespace mebots::soc::test
