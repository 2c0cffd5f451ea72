// SPDX-License-Identifier: Apache-2.0
// Tests the registers of GAP8's devices on board gap8 against the public headers.
#include "board_system.hpp"
#include "devices/core/described_device.hpp"
#include "devices/gap8/event_unit.hpp"
#include "devices/gap8/hyper_flash.hpp"
#include "devices/gap8/soc_events.hpp"
#include "devices/gap8/timer.hpp"
#include "support/same_state.hpp"

#include "mebots/state/save.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::soc::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

BoardDescription gap8_board() {
  return read_board(MEBOTS_SOURCE_DIR "/configs/boards/gap8.json");
}

BoardSystem on_gap8(std::string_view text) {
  return BoardSystem(text, {}, gap8_board());
}

TEST(Gap8, FabricControllerIsClusterThirtyTwoAndSeesItsMemoryTwice) {
  auto system = on_gap8(R"(
_start: li s1, 0x1C060000
    csrr a0, mhartid
    sw a0, 0(s1)
    csrr a0, 0x014
    sw a0, 4(s1)
    li s2, 0x1B000000
    li a0, 0x12345678
    sw a0, 0x100(s2)
    lw a1, 0x100(zero)
    sw a1, 8(s1)
    li a0, 0xab
    sb a0, 0x101(zero)
    lw a1, 0x100(s2)
    sw a1, 12(s1)
    lw a1, 0x102(zero)
    sw a1, 16(s1)
1:  j 1b
)");
  system.soc.advance(1 * kMs);
  EXPECT_EQ(system.result(0), 0x400U);
  EXPECT_EQ(system.result(1), 0x400U);
  EXPECT_EQ(system.result(2), 0x12345678U);
  EXPECT_EQ(system.result(3), 0x1234ab78U);
  EXPECT_EQ(system.result(4) & 0xffffU, 0x1234U) << "across two words";
}

TEST(Gap8, ShowsThePrivilegeAndClearsTheCauseAtMret) {
  auto system = on_gap8(R"(
_start: li s1, 0x1C060000
    la t0, vectors
    csrw mtvec, t0
    csrr a0, 0xC10         # of RI5CY: the privilege level
    sw a0, 0(s1)
    ecall
    csrr a0, mcause
    sw a0, 8(s1)
1:  j 1b
handler: csrr a0, mcause
    sw a0, 4(s1)
    csrr a0, mepc
    addi a0, a0, 4
    csrw mepc, a0
    mret
    .option norvc
    .balign 256
vectors: .rept 34
    j vectors
    .endr
    j handler              # of calls: at 0x88
)");
  system.soc.advance(1 * kMs);
  EXPECT_EQ(system.result(0), 3U) << "machine mode";
  EXPECT_EQ(system.result(1), 11U) << "a call of the handler";
  EXPECT_EQ(system.result(2), 0U);
}

TEST(Gap8, AlternatingFaultsOfHandlersEndTheCore) {
  auto system = on_gap8(R"(
_start: la t0, vectors
    csrw mtvec, t0
    li sp, 0x40000000
    .word 0xffffffff
    .balign 256
vectors: .rept 33
    .word 0
    .endr
    .word 0x00012083       # of illegal instructions, at 0x84: lw ra, 0(sp), where no memory is
    .word 0
    .word 0xffffffff       # of that load, at 0x8c
)");
  system.soc.advance(1 * kMs);
  EXPECT_THAT(system.soc.fault_text(), HasSubstr("an exception in its own trap handler"));
}

TEST(Gap8, RegistersWithoutAModelAreReportedOnceAndTheProgramContinues) {
  auto system = on_gap8(R"(
_start: li s1, 0x1C060000
    li s0, 0x1A103004      # no device
    li a0, 7
    sw a0, 0(s0)
    lw a1, 0(s0)
    lw a1, 0(s0)
    sw a1, 0(s1)
    li s0, 0x1A1000F0      # behind the loops
    lw a1, 0(s0)
    sw a1, 4(s1)
    lb a1, 0x11(s0)
    li a0, 0x600d
    sw a0, 8(s1)
1:  j 1b
)");
  system.soc.advance(1 * kMs);
  EXPECT_EQ(system.result(0), 0U);
  EXPECT_EQ(system.result(2), 0x600dU);
  ASSERT_EQ(system.faults.size(), 3U);
  EXPECT_THAT(system.faults[0], HasSubstr("store into 0x1a103004 in _start"));
  EXPECT_THAT(system.faults[0], HasSubstr("the board has no device there"));
  EXPECT_THAT(system.faults[1], HasSubstr("load from 0x1a1000f0"));
  EXPECT_THAT(system.faults[1], HasSubstr("device fll of kind gap8_fll has no such register"));
  EXPECT_FALSE(system.soc.faulted());
}

TEST(Gap8, AnAccessElsewhereIsAFault) {
  auto system = on_gap8("_start: li s0, 0x1A200000\nlw a0, 0(s0)\n1: j 1b\n");
  system.soc.advance(1 * kMs);
  EXPECT_TRUE(system.soc.faulted());
}

TEST(Gap8, EventCountersHaveUserNumbersToo) {
  auto system = on_gap8(R"(
_start: li s1, 0x1C060000
    li a0, 3
    csrw 0xCC0, a0         # cycles and instructions
    li a0, 1
    csrw 0xCC1, a0
    csrr a0, 0x7A0
    sw a0, 0(s1)
    csrr a0, 0x7A1
    sw a0, 4(s1)
    csrw 0x79F, zero
    nop
    nop
    csrr a0, 0x781
    sw a0, 8(s1)
1:  j 1b
)");
  system.soc.advance(1 * kMs);
  EXPECT_TRUE(system.faults.empty()) << system.faults.front();
  EXPECT_EQ(system.result(0), 3U);
  EXPECT_EQ(system.result(1), 1U);
  EXPECT_GE(system.result(2), 2U);
}

TEST(Gap8, RunsTheHelloProgramOfTheOpenPulpChip) {
  BoardSystem system(R"(
_start: csrw 0xCC1, zero
    li s0, 0x1A109800
    li a0, -1
    sw a0, 8(s0)
    li s0, 0x1A10F000
    csrr a1, mhartid       # cluster 31, core 0
    srli a2, a1, 5
    slli a2, a2, 7
    add s0, s0, a2
    li a0, 'h'
    sb a0, 0(s0)
    li a0, 'i'
    sb a0, 0(s0)
    li a0, 10
    sb a0, 0(s0)
    li s0, 0x1A1040A0
    li a0, 0x80000005
    sw a0, 0(s0)
1:  wfi
    j 1b
)",
                     {}, read_board(MEBOTS_SOURCE_DIR "/configs/boards/pulp_open.json"));
  system.soc.advance(1 * kMs);
  EXPECT_TRUE(system.faults.empty()) << system.faults.front();
  EXPECT_THAT(system.console, ElementsAre("hi"));
  EXPECT_EQ(system.soc.exit_code(), 5);
}

TEST(Gap8, FusesAreProgrammedBitByBitAndReadAsBytes) {
  auto system = on_gap8(R"(
_start: li s1, 0x1C060000
    li s2, 0x1A109000
    li a0, 2
    sw a0, 0(s2)           # program
    li a0, 0x104
    sb a0, 0x200(s2)       # bit 4 of the first: a byte
    li a0, 0
    sw a0, 0x3fc(s2)       # bits 0 and 7 of the last
    li a0, 7
    sb a0, 0x3fc(s2)
    li a0, 1
    sw a0, 0(s2)           # read
    lbu a0, 0x200(s2)
    sw a0, 0(s1)
    lw a0, 0x3fc(s2)
    sw a0, 4(s1)
    lb a0, 0x3fc(s2)
    sw a0, 8(s1)
    sb zero, 0x200(s2)     # not the command for it
    lbu a0, 0x200(s2)
    sw a0, 12(s1)
    li a0, 4
    sw a0, 0(s2)           # sleep
    lw a0, 0x200(s2)
    sw a0, 16(s1)
1:  j 1b
)");
  system.soc.advance(1 * kMs);
  EXPECT_EQ(system.result(0), 0x10U);
  EXPECT_EQ(system.result(1), 0x81U);
  EXPECT_EQ(system.result(2), 0xffffff81U);
  EXPECT_EQ(system.result(3), 0x10U);
  EXPECT_EQ(system.result(4), 0U);
  EXPECT_THAT(system.faults, ElementsAre(HasSubstr("efuse: a fuse was written without the command program"),
                                         HasSubstr("efuse: a fuse was read without the command read")));
}

TEST(Gap8, CodeChangedThroughAnAliasRunsAsChanged) {
  auto system = on_gap8(R"(
_start: li s2, 0x1B000200
    li a0, 0x00150513      # addi a0, a0, 1
    sw a0, 0(s2)
    li a1, 0x00008067      # ret
    sw a1, 4(s2)
    fence.i
    li a0, 5
    jalr s2
    mv s3, a0
    li a1, 0x10050513      # addi a0, a0, 256
    sw a1, 0x200(zero)
    li a0, 5
    jalr s2
1:  j 1b
)");
  system.soc.advance(1 * kMs);
  EXPECT_EQ(system.soc.hart().reg(19), 6U);
  EXPECT_EQ(system.soc.hart().reg(10), 261U);
}

TEST(Gap8, ReportsARegisterWithoutAModelOnceAndContinues) {
  auto system = on_gap8(R"(
_start: li s0, 0x1A102000
    li a2, 3
1:  lw a0, 0x14(s0)
    sw a2, 0x14(s0)
    sw a2, 0x780(s0)
    lw a1, 0x780(s0)
    addi a2, a2, -1
    bnez a2, 1b
2:  j 2b
)");
  system.soc.advance(1 * kMs);
  EXPECT_EQ(system.soc.hart().reg(10), 0U);
  EXPECT_EQ(system.soc.hart().reg(11), 1U) << "a register that is described keeps what is stored";
  ASSERT_EQ(system.faults.size(), 1U);
  EXPECT_THAT(system.faults[0], HasSubstr("udma: load from 0x1a102014 in _start"));
}

TEST(Gap8, PrintsAndEndsAsProgramsOfItsSdkDo) {
  auto system = on_gap8(R"(
_start: li s0, 0x1A110F80
    li a0, 'o'
    sb a0, 0(s0)
    li a0, 'k'
    sb a0, 0(s0)
    li a0, '\n'
    sb a0, 0(s0)
    li s0, 0x1A104000
    li a0, 0x80000007
    sw a0, 0xa0(s0)
1:  j 1b
)");
  system.soc.advance(1 * kMs);
  EXPECT_THAT(system.console, ElementsAre("ok"));
  EXPECT_EQ(system.soc.end(), End::exited);
  EXPECT_EQ(system.soc.exit_code(), 7);
}

TEST(Gap8, LoopsSetTheClocksAndSocControlTheVoltage) {
  auto system = on_gap8(R"(
_start: li s0, 0x1A100000
    li a0, 0x84000BEC      # locked, divider 1, factor 3052
    sw a0, 4(s0)
    lw a1, 0(s0)
    li a0, 0x8C0005F5      # divider 3
    sw a0, 0x14(s0)
    li s1, 0x1A104000
    li a0, 9
    sw a0, 0x100(s1)
1:  j 1b
)");
  EXPECT_EQ(system.soc.power().clock_hz(), 1525 * 32768.0) << "as after reset";
  EXPECT_EQ(system.soc.power().voltage_v(), 1.2);
  system.soc.advance(1 * kMs);
  EXPECT_EQ(system.soc.power().clock_hz(), 3052 * 32768.0);
  EXPECT_EQ(system.soc.hart().reg(11), 3052U) << "the loop has locked";
  EXPECT_EQ(system.soc.power().voltage_v(), 1.0);
}

/// Waits for event 11 of the timer's high counter with interrupts off, enables the interrupt, and raises SoC event 3.
constexpr std::string_view kEvents = R"(
    .balign 256
    .option push
    .option norvc
vectors: .rept 11
    j unexpected
    .endr
    j on_timer
    .rept 15
    j unexpected
    .endr
    j on_soc_event
    .rept 4
    j unexpected
    .endr
    j unexpected
    j on_illegal
    .option pop
    .globl _start
_start: la t0, vectors
    csrw mtvec, t0
    li s0, 0x00204000
    li s1, 0x1C060000
    li s2, 0x00200400
    li s3, 0x1A106000
    li a0, 0x08000800
    sw a0, 0x08(s0)        # events 11 and 27 end a wait
    sw a0, 0x14(s0)        # and interrupt
    li a0, 33
    sw a0, 0x14(s2)        # compare of the high counter
    li a0, 0xA7            # on, from 0, interrupt, one shot, reference clock
    sw a0, 0x04(s2)
    .insn i 0x03, 6, a1, 0x38(s0)
    sw a1, 0(s1)
    lw a2, 0x0c(s2)
    sw a2, 4(s1)
    csrwi mstatus, 8
    li a0, -1
    li a1, ~(1 << 19)
    and a0, a0, a1
    sw a0, 0x04(s3)        # the fabric controller hears event 51
    li a0, 8
    sw a0, 0(s3)
    nop
    .4byte 0xffffffff
1:  .insn i 0x03, 6, a1, 0x38(s0)
    j 1b
on_timer: lw a3, 0x1c(s0)
    sw a3, 8(s1)
    lw a3, 20(s1)
    addi a3, a3, 1
    sw a3, 20(s1)
    mret
on_soc_event: li a3, 0x00200800
    lw a3, 0x700(a3)
    sw a3, 12(s1)
    li a4, 0x08000000
    sw a4, 0x28(s0)
    mret
on_illegal: csrr a3, mcause
    sw a3, 16(s1)
    csrr a3, mepc
    addi a3, a3, 4
    csrw mepc, a3
    mret
unexpected: j unexpected
)";

TEST(Gap8, WaitsForItsTimerAndTakesTheEventsOfTheSocFromTheirQueue) {
  auto system = on_gap8(kEvents);
  system.soc.advance(5 * kMs);
  EXPECT_TRUE(system.faults.empty()) << system.faults.front();
  EXPECT_EQ(system.result(0), 1U << 11) << "the wait does not clear";
  EXPECT_EQ(system.result(1), 33U) << "one shot: it stands";
  EXPECT_EQ(system.result(2), 0U) << "taking the interrupt cleared the event";
  EXPECT_EQ(system.result(5), 1U) << "once";
  EXPECT_EQ(system.result(3), 0x80000000U | 51U);
  EXPECT_EQ(system.result(4), 2U) << "an illegal instruction goes to its own vector";
  // 33 edges of 32768 Hz are 1.007 ms.
  EXPECT_NEAR(static_cast<double>(system.soc.sleep_time()) * 1e-12, 5e-3, 50e-6) << "asleep but for a few instructions";
}

TEST(Gap8, ContinuesFromAState) {
  auto straight = on_gap8(kEvents);
  auto first = on_gap8(kEvents);
  auto second = on_gap8(kEvents);
  straight.soc.advance(2 * kMs);
  first.soc.advance(500'000);  // during the wait
  state::restore(second.soc, state::save(first.soc));
  second.soc.advance(2 * kMs);
  EXPECT_TRUE(mebots::test::same_state(second.soc, straight.soc));
}

TEST(Gap8, CopiesBytesOverTheHyperBusAndRaisesAnEventAtTheEnd) {
  Settings settings;
  settings.flash.resize(0x200);
  for (std::size_t i = 0; i < settings.flash.size(); ++i) settings.flash[i] = static_cast<std::uint8_t>(i * 7);
  BoardSystem system(R"(
_start: li s0, 0x1A102180
    li s1, 0x1C060000
    li s2, 0x00204000
    li s3, 0x1A106000
    li a0, 0xffffff3f      # hears events 6 and 7
    sw a0, 0x08(s3)
    li a0, 0x08000000
    sw a0, 0x08(s2)
    li a0, 0x01000080      # 64 bytes of the flash from 0x80 on
    sw a0, 0x20(s0)
    sw s1, 0(s0)
    li a0, 64
    sw a0, 4(s0)
    li a0, 0x14
    sw a0, 8(s0)
    lw a1, 8(s0)
    sw a1, 0x100(s1)
    call wait
    sw a3, 0x104(s1)
    lw a1, 8(s0)
    sw a1, 0x108(s1)
    li a0, 0x1234          # into the RAM
    sw a0, 0x20(s0)
    sw s1, 0x10(s0)
    li a0, 64
    sw a0, 0x14(s0)
    li a0, 0x14
    sw a0, 0x18(s0)
    call wait
    sw a3, 0x10c(s1)
    li a0, 0x1230          # and from it: 4 bytes that were never written first
    sw a0, 0x20(s0)
    addi a1, s1, 0x40
    sw a1, 0(s0)
    li a0, 8
    sw a0, 4(s0)
    li a0, 0x14
    sw a0, 8(s0)
    call wait
    li a0, 0x010001FC      # the end of the image: erased behind it
    sw a0, 0x20(s0)
    addi a1, s1, 0x48
    sw a1, 0(s0)
    li a0, 0x14
    sw a0, 8(s0)
    call wait
1:  j 1b
wait: .insn i 0x03, 6, a4, 0x38(s2)
    li a3, 0x00200800
    lw a3, 0x700(a3)
    li a4, 0x08000000
    sw a4, 0x28(s2)
    ret
)",
                     settings, gap8_board());
  system.soc.advance(1 * kMs);
  EXPECT_TRUE(system.faults.empty()) << system.faults.front();
  for (std::uint32_t i = 0; i < 16; ++i) {
    std::uint32_t expected = 0;
    for (std::uint32_t byte = 0; byte < 4; ++byte) expected |= ((0x80 + 4 * i + byte) * 7 & 0xffU) << 8 * byte;
    EXPECT_EQ(system.result(i), expected) << i;
  }
  EXPECT_EQ(system.result(64), 0x10U) << "one runs, none is queued";
  EXPECT_EQ(system.result(65), 0x80000006U);
  EXPECT_EQ(system.result(66), 0U) << "done";
  EXPECT_EQ(system.result(67), 0x80000007U);
  EXPECT_EQ(system.result(16), 0U);
  EXPECT_EQ(system.result(17), system.result(0)) << "what was sent";
  EXPECT_EQ(system.result(18) >> 24, 0x1FFU * 7 & 0xffU);
  EXPECT_EQ(system.result(19), 0xffffffffU);
}

TEST(Gap8, SendsBytesOverTheUartAtItsBitRate) {
  BoardSystem system(R"(
_start: li s0, 0x1A102200
    li s1, 0x1C060000
    li s2, 0x1A10B000
    li a0, 0x00090106      # ten clocks a bit, eight bits, one stop
    sw a0, 0x24(s0)
    la a0, text
    sw a0, 0x10(s0)
    li a0, 6
    sw a0, 0x14(s0)
    li a0, 0x10
    sw a0, 0x18(s0)
    csrr s3, mcycle
1:  lw a0, 0x20(s0)
    bnez a0, 1b
    csrr s4, mcycle
    sub s4, s4, s3
    sw s4, 0(s1)
2:  j 2b
text: .ascii "hello\n"
)",
                     {}, gap8_board());
  system.soc.advance(1 * kMs);
  EXPECT_THAT(system.console, ElementsAre("hello"));
  EXPECT_NEAR(system.result(0), 6 * 10 * 10, 25) << "cycles; a turn of the loop takes some, and its code is fetched";
}

TEST(Gap8, AReceiverWithoutASenderWaitsUntilItsChannelIsCleared) {
  BoardSystem system(R"(
_start: li s0, 0x1A102200
    li s1, 0x1C060000
    sw s1, 0(s0)
    li a0, 4
    sw a0, 4(s0)
    li a0, 0x10
    sw a0, 8(s0)
    li a1, 1000
1:  addi a1, a1, -1
    bnez a1, 1b
    lw a0, 8(s0)
    sw a0, 0x40(s1)
    li a0, 0x20
    sw a0, 8(s0)
    lw a0, 8(s0)
    sw a0, 0x44(s1)
    lw a0, 0x20(s0)        # the transmitter rests
    sw a0, 0x48(s1)
2:  j 2b
)",
                     {}, gap8_board());
  system.soc.advance(1 * kMs);
  EXPECT_TRUE(system.faults.empty()) << system.faults.front();
  EXPECT_EQ(system.result(16), 0x10U);
  EXPECT_EQ(system.result(17), 0U);
  EXPECT_EQ(system.result(18), 0U);
  EXPECT_EQ(system.result(0), 0U);
}

class Gap8HyperFlash : public testing::Test {
 protected:
  Gap8HyperFlash() {
    for (std::size_t i = 0; i < image.size(); ++i) image[i] = static_cast<std::uint8_t>(i * 7);
  }
  bool tell(std::uint32_t word_address, std::uint8_t word, std::uint32_t shift = 1) {
    const std::array<std::uint8_t, 2> bytes{word, 0};
    return flash.write(word_address << shift, bytes);
  }
  bool unlock() { return tell(0x555, 0xAA) && tell(0x2AA, 0x55); }
  bool program(std::uint32_t place, const std::vector<std::uint8_t>& bytes) {
    return unlock() && tell(0x555, 0xA0) && flash.write(place, bytes);
  }
  bool erase_sector(std::uint32_t place) { return unlock() && tell(0x555, 0x80) && unlock() && tell(place, 0x30, 0); }
  std::vector<std::uint8_t> read(std::uint32_t place, std::size_t count) {
    std::vector<std::uint8_t> bytes(count);
    flash.read(place, bytes);
    return bytes;
  }

  static constexpr std::uint32_t kSector = gap8_devices::HyperFlash::kSectorBytes;
  std::vector<std::uint8_t> image = std::vector<std::uint8_t>(kSector + 100);
  gap8_devices::HyperFlash flash{image};
};

TEST_F(Gap8HyperFlash, ErasesASectorProgramsItAndReadsItBack) {
  EXPECT_TRUE(erase_sector(kSector));
  EXPECT_EQ(read(kSector, 100), std::vector<std::uint8_t>(100, 0xff));
  EXPECT_EQ(read(kSector - 1, 2), (std::vector<std::uint8_t>{image[kSector - 1], 0xff})) << "the one before stays";
  std::vector<std::uint8_t> line(512);
  for (std::size_t i = 0; i < line.size(); ++i) line[i] = static_cast<std::uint8_t>(i * 3 + 1);
  for (std::uint32_t at = 0; at < kSector; at += 512) ASSERT_TRUE(program(kSector + at, line));
  for (std::uint32_t at = 0; at < kSector; at += 512) ASSERT_EQ(read(kSector + at, 512), line);
  EXPECT_EQ(read(2 * kSector, 1).front(), 0xff);
}

TEST_F(Gap8HyperFlash, ProgramsZerosOnlyAndWithinALine) {
  EXPECT_TRUE(program(0x100, {0x0f, 0xff}));
  EXPECT_EQ(read(0x100, 2), (std::vector<std::uint8_t>{static_cast<std::uint8_t>(image[0x100] & 0x0fU), image[0x101]}));
  EXPECT_FALSE(program(0x1ff, {0, 0}));
  EXPECT_EQ(read(0x1ff, 1).front(), image[0x1ff]);
}

TEST_F(Gap8HyperFlash, ShowsItsStatusOnceAndErasesAll) {
  EXPECT_TRUE(tell(0x555, 0x70));
  EXPECT_EQ(read(0, 4), (std::vector<std::uint8_t>{0x80, 0, 0x80, 0}));
  EXPECT_EQ(read(0, 1).front(), image[0]);
  EXPECT_TRUE(unlock() && tell(0x555, 0x80) && unlock() && tell(0x555, 0x10));
  EXPECT_EQ(read(kSector - 2, 4), std::vector<std::uint8_t>(4, 0xff));
}

TEST_F(Gap8HyperFlash, ResetsASequenceOutOfOrder) {
  EXPECT_FALSE(tell(0x555, 0xA0)) << "not unlocked";
  EXPECT_TRUE(tell(0x555, 0xAA));
  EXPECT_FALSE(tell(0x555, 0x55)) << "another address";
  EXPECT_FALSE(flash.write(0, std::vector<std::uint8_t>(4)));
  EXPECT_FALSE(tell(0, 0x30));
  EXPECT_EQ(read(0, 4), std::vector<std::uint8_t>(image.begin(), image.begin() + 4));
}

TEST_F(Gap8HyperFlash, ContinuesFromAState) {
  EXPECT_TRUE(program(0x10, {0}));
  EXPECT_TRUE(unlock() && tell(0x555, 0xA0));
  gap8_devices::HyperFlash other{image};
  state::restore(other, state::save(flash));
  EXPECT_TRUE(other.write(0x20, std::vector<std::uint8_t>{0}));
  std::vector<std::uint8_t> bytes(0x11);
  other.read(0x10, bytes);
  EXPECT_EQ(bytes.front() | bytes.back(), 0);
}

TEST(Gap8, RefusesAFlashImageThatIsTooLarge) {
  Settings settings;
  settings.flash.resize((64U << 20) + 1);
  EXPECT_THAT([&] { BoardSystem(BoardSystem::assembled("_start: j _start\n"), settings, gap8_board()); },
              testing::ThrowsMessage<Error>(HasSubstr("the flash image has 67108865 bytes")));
}

TEST(Gap8EventUnit, KeepsTheQueuesEventSetUntilTheQueueIsEmpty) {
  gap8_devices::Signals signals;
  gap8_devices::EventUnit unit(signals);
  unit.store(0x0C, 0xffffffffU);
  unit.queue_soc_event(5);
  unit.queue_soc_event(6);
  EXPECT_EQ(unit.lines(), 1U << 27);
  EXPECT_EQ(unit.take_soc_event(), 0x80000005U);
  unit.store(0x28, 1U << 27);
  EXPECT_EQ(unit.lines(), 1U << 27) << "another one waits";
  EXPECT_EQ(unit.take_soc_event(), 0x80000006U);
  unit.store(0x28, 1U << 27);
  EXPECT_EQ(unit.lines(), 0U);
  EXPECT_EQ(unit.take_soc_event(), 0U) << "nothing: not valid";
}

TEST(Gap8EventUnit, PresentsTheHighestUnmaskedEvent) {
  gap8_devices::Signals signals;
  gap8_devices::EventUnit unit(signals);
  signals.raise_fabric_event(3);
  signals.raise_fabric_event(12);
  EXPECT_EQ(unit.lines(), 0U);
  unit.store(0x14, 1U << 3);
  EXPECT_EQ(unit.lines(), 1U << 3);
  unit.store(0x14, 1U << 12);
  EXPECT_EQ(unit.lines(), 1U << 12);
  unit.acknowledge(12);
  EXPECT_EQ(unit.lines(), 1U << 3);
  unit.store(0x10, 1U << 3);
  EXPECT_EQ(unit.lines(), 0U) << "masked again";
  std::uint32_t buffer = 0;
  EXPECT_TRUE(unit.load(0x1C, buffer));
  EXPECT_EQ(buffer, 1U << 3);
}

TEST(Gap8EventUnit, AnswersAWaitWhenAnUnmaskedEventIsPending) {
  gap8_devices::Signals signals;
  gap8_devices::EventUnit unit(signals);
  unit.store(0x00, 1U << 4);
  EXPECT_EQ(unit.load_event(0x3C).kind, BusReply::Kind::blocked);
  unit.raise(5);
  EXPECT_FALSE(unit.take_wake());
  unit.raise(4);
  EXPECT_TRUE(unit.take_wake());
  EXPECT_FALSE(unit.take_wake()) << "once";
  EXPECT_EQ(unit.load_event(0x3C).value, 1U << 4);
  EXPECT_EQ(unit.load_event(0x3C).kind, BusReply::Kind::blocked) << "the load has cleared it";
}

TEST(Gap8SocEvents, DeliverUnmaskedEventsAndTheReferenceClock) {
  gap8_devices::Signals signals;
  std::vector<unsigned> heard;
  gap8_devices::SocEvents events(signals, [&](unsigned event) { heard.push_back(event); });
  EXPECT_EQ(events.next_event(), kNever) << "all masked after reset";
  signals.raise_soc_event(37, 0);
  EXPECT_TRUE(heard.empty());
  events.store(0x04, 0, ~(1U << 5));
  signals.raise_soc_event(37, 0);
  EXPECT_THAT(heard, ElementsAre(37U));
  const Picoseconds later = 1'000'000'000;
  events.store(0x04, later, ~(1U << 24));
  EXPECT_EQ(events.next_event(), gap8_devices::reference_edge_time(33)) << "1 ms is after edge 32";
  events.advance(events.next_event());
  EXPECT_THAT(heard, ElementsAre(37U, 56U));
}

constexpr Picoseconds kMicrosecond = 1'000'000;

std::uint32_t read(gap8_devices::Timer& timer, std::uint32_t offset, Picoseconds now) {
  std::uint32_t value = 0;
  EXPECT_TRUE(timer.load(offset, now, value));
  return value;
}

TEST(Gap8Timer, CountsTheCoresClockAndRestartsAtAMatch) {
  gap8_devices::Signals signals;
  std::vector<unsigned> raised;
  signals.raise_fabric_event = [&](unsigned event) { raised.push_back(event); };
  gap8_devices::Timer timer(signals, [] { return 50e6; });
  timer.store(0x10, 0, 1000);
  timer.store(0x00, 0, 0x15);  // enabled, raises the interrupt, clears at the comparison
  EXPECT_EQ(read(timer, 0x08, 10 * kMicrosecond), 500U);
  EXPECT_EQ(timer.next_event(), 20 * kMicrosecond);
  timer.advance(20 * kMicrosecond);
  EXPECT_THAT(raised, ElementsAre(10U));
  EXPECT_EQ(read(timer, 0x08, 20 * kMicrosecond), 0U);
  EXPECT_EQ(timer.next_event(), 40 * kMicrosecond);
  timer.store(0x00, 30 * kMicrosecond, 0);
  EXPECT_EQ(read(timer, 0x08, 90 * kMicrosecond), 500U) << "stands while it is off";
}

TEST(Gap8Timer, DividesByItsPrescalerAndCountsInPairs) {
  gap8_devices::Signals signals;
  gap8_devices::Timer timer(signals, [] { return 50e6; });
  timer.store(0x00, 0, 1U | 1U << 6 | 4U << 8);  // counts every fifth cycle
  EXPECT_EQ(read(timer, 0x08, 10 * kMicrosecond), 100U);
  timer.store(0x00, 10 * kMicrosecond, 1U << 31);
  timer.store(0x08, 10 * kMicrosecond, 0xffffff00U);
  timer.store(0x0C, 10 * kMicrosecond, 7);
  timer.store(0x00, 10 * kMicrosecond, 1U << 31 | 1U);
  EXPECT_EQ(read(timer, 0x0C, 20 * kMicrosecond), 8U) << "500 cycles carry over";
  EXPECT_EQ(read(timer, 0x08, 20 * kMicrosecond), 500U - 256U);
}

TEST(Gap8Timer, KeepsItsCountWhenTheClockChanges) {
  gap8_devices::Signals signals;
  double hz = 50e6;
  gap8_devices::Timer timer(signals, [&] { return hz; });
  timer.store(0x00, 0, 1);
  signals.clock_changes(10 * kMicrosecond);
  hz = 100e6;
  EXPECT_EQ(read(timer, 0x08, 20 * kMicrosecond), 500U + 1000U);
}

}  // namespace
}  // namespace mebots::soc::test
