// SPDX-License-Identifier: Apache-2.0
// Tests the devices of board virt against their specifications, and the cycles of interrupts. Expected cycles are
// computed from the clock and the RISC-V specifications.
#include "assembler.hpp"
#include "devices/core/chip_host.hpp"
#include "soc/soc.hpp"
#include "support/same_state.hpp"

#include "mebots/error.hpp"
#include "mebots/state/save.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>
#include <string>
#include <vector>

namespace mebots::soc::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::uint32_t kResults = 0x80010000;
/// Cycles from the interrupt to the handler's first instruction (docs/chip/time.md).
constexpr std::uint64_t kEntryCycles = 4;
constexpr std::uint64_t kPeriodNs = 100;

constexpr std::string_view kNames = R"(
#define MSWI 0x02000000
#define COMPARE 0x02004000
#define COUNT 0x0200bff8
#define PLIC 0x0c000000
#define UART 0x10000000
#define FINISHER 0x00100000
#define RESULTS 0x80010000
)";

/// Board virt with a program of assembly text. The program reads `input` from the console.
class VirtSystem {
 public:
  explicit VirtSystem(std::string_view text, const Settings& settings = {}, std::string_view input = {})
      : VirtSystem(text, settings, input, 0) {}
  /// An access to RAM takes `wait_cycles` more cycles.
  VirtSystem(std::string_view text, const Settings& settings, std::string_view input, std::uint32_t wait_cycles)
      : input_(input.begin(), input.end()),
        soc(board(wait_cycles), gap8(), settings, assemble(fmt::format("{}\n{}\n", kNames, text)), listeners()) {}

  Device& device(std::string_view name) { return *soc.devices().find(name); }
  std::uint32_t result(std::uint32_t index) const {
    std::uint32_t value = 0;
    soc.memory().read(kResults + 4 * index, {reinterpret_cast<std::uint8_t*>(&value), sizeof value});
    return value;
  }

 private:
  static BoardDescription board(std::uint32_t wait_cycles) {
    auto board = read_board(MEBOTS_SOURCE_DIR "/configs/boards/virt.json");
    if (wait_cycles != 0) board.memories.front().latency = BoardLatency{.fabric_controller = wait_cycles};
    return board;
  }

  Listeners listeners() {
    Listeners listeners;
    listeners.faults = [this](std::string_view text) { faults.emplace_back(text); };
    listeners.console_byte = [this](std::uint8_t byte) { output += static_cast<char>(byte); };
    listeners.console_input = [this](Picoseconds now, bool /*waits*/) {
      asked_at.push_back(now);
      if (input_.empty()) return ConsolePort::kEnded;
      const auto byte = static_cast<std::uint8_t>(input_.front());
      input_.pop_front();
      return int{byte};
    };
    return listeners;
  }

  std::deque<char> input_;

 public:
  std::string output;
  std::vector<std::string> faults;
  std::vector<Picoseconds> asked_at;
  Soc soc;
};

std::uint32_t load(Device& device, std::uint32_t offset, Picoseconds now = 0) {
  std::uint32_t value = 0xdeadbeef;
  EXPECT_TRUE(device.load(offset, now, value));
  return value;
}

void store(Device& device, std::uint32_t offset, std::uint32_t value, Picoseconds now = 0) {
  EXPECT_TRUE(device.store(offset, now, value));
}

/// Returns a program that waits in `wait` for the timer at tick `compare`. The handler's first instruction reads
/// mcycle.
std::string timer_program(std::uint32_t compare, std::string_view wait) {
  return fmt::format(R"(
_start: la t0, handler
    csrw mtvec, t0
    li t0, COMPARE
    li t1, {}
    sw t1, 0(t0)
    sw zero, 4(t0)
    li t0, 1 << 7
    csrw mie, t0
    csrsi mstatus, 8
    li s0, 20000
{}
    .balign 4
    .option norvc
handler: csrr a0, mcycle
    li t0, RESULTS
    sw a0, 0(t0)
    csrr a1, mcause
    sw a1, 4(t0)
    li t0, FINISHER
    li t1, 0x5555
    sw t1, 0(t0)
1:  j 1b
)",
                     compare, wait);
}

std::uint64_t first_cycle_at(std::uint64_t time_ns, std::uint64_t clock_hz) {
  return (time_ns * clock_hz + 999'999'999) / 1'000'000'000;
}

TEST(Virt, TimerInterruptEntersItsHandlerInTheCycleOfItsTick) {
  // Every instruction of the loop takes one cycle, so an interrupt can occur in each cycle.
  const std::string sled = "1: .rept 2000\nnop\n.endr\nj 1b";
  for (const double clock_hz : {100e6, 87e6, 33e6, 250e6}) {
    for (const std::uint32_t tick : {30U, 31U, 77U}) {
      Settings settings;
      settings.clock_hz = clock_hz;
      VirtSystem system(timer_program(tick, sled), settings);
      system.soc.run_cycles(100'000);
      EXPECT_EQ(system.soc.end(), End::exited);
      EXPECT_EQ(system.result(0), first_cycle_at(tick * kPeriodNs, static_cast<std::uint64_t>(clock_hz)) + kEntryCycles)
          << clock_hz << " Hz, tick " << tick;
      EXPECT_EQ(system.result(1), 0x80000007U);
    }
  }
}

TEST(Virt, TimerInterruptIsExactInTranslatedCodeToo) {
  for (const bool translate : {false, true}) {
    Settings settings;
    settings.translate = translate;
    constexpr std::uint32_t kTick = 20'001;  // 2 ms: the loop is hot by then
    // Only the jump takes more than one cycle, so the interrupt is late by at most the cycles of the jump.
    VirtSystem system(timer_program(kTick, "1: .rept 10\nadd a2, a2, s0\n.endr\nj 1b"), settings);
    system.soc.run_cycles(1'000'000);
    const auto due = first_cycle_at(kTick * kPeriodNs, 100'000'000) + kEntryCycles;
    EXPECT_GE(system.result(0), due);
    EXPECT_LE(system.result(0), due + 1) << "a jump takes two cycles";
  }
}

/// Loads from devices, accesses to CSRs, and traps, some of them directly after loads. The timer interrupts every 3 us;
/// interrupts that are disabled stay pending.
constexpr std::string_view kRareInstructions = R"(
    .option arch, +f
_start: la t0, handler
    csrw mtvec, t0
    li s0, COMPARE
    li s1, COUNT
    li s2, PLIC + 4
    li s3, UART
    la s4, data
    li t0, 5
    sw t0, 0(s2)
    li t0, 30
    sw t0, 0(s0)
    sw zero, 4(s0)
    li t0, 1 << 7
    csrw mie, t0
    li t0, 1 << 13
    csrs mstatus, t0
    li t0, 3
    fcvt.s.w ft0, t0
    csrsi mstatus, 8
loop: lw a0, 0(s1)
    add s5, s5, a0
    fdiv.s ft1, ft1, ft0
    fadd.s ft1, ft1, ft0
    lbu a1, 5(s3)
    add s5, s5, a1
    lw a2, 0(s2)
    lw a2, 0(s4)
    csrrs a3, mcycle, x0
    xor s5, s5, a3
    lw a4, 0(s4)
    csrr a4, mcycle
    csrr a5, minstret
    add s5, s5, a4
    add s5, s5, a5
    csrci mstatus, 8
    addi a2, a2, 1
    sw a2, 0(s4)
    csrsi mstatus, 8
    .option push
    .option norvc
    ecall
    .option pop
    csrrw s6, mscratch, s5
    andi t1, a2, 7
    bnez t1, loop
1:  lw t2, 0(s1)
    sub t3, t2, a0
    sltiu t3, t3, 5
    bnez t3, 1b
    lb t4, -3(s2)
    lhu t4, 2(s4)
    j loop
    .balign 4
    .option norvc
handler: csrr t0, mcause
    bltz t0, 2f
    csrr t0, mepc
    addi t0, t0, 4
    csrw mepc, t0
    addi s7, s7, 1
    mret
2:  lw t0, 0(s0)
    addi t0, t0, 30
    sw t0, 0(s0)
    addi s8, s8, 1
    mret
    .data
    .balign 4
data: .word 0, 0
    .text
)";

/// The parameter is the number of wait cycles of the RAM.
class VirtRam : public testing::TestWithParam<std::uint32_t> {};

TEST_P(VirtRam, RareInstructionsAreExactInTranslatedCode) {
  Settings settings;
  VirtSystem translated(kRareInstructions, settings, {}, GetParam());
  settings.translate = false;
  VirtSystem interpreted(kRareInstructions, settings, {}, GetParam());
  std::int64_t time_ns = 0;
  for (std::uint32_t step = 0; time_ns < 6'000'000; ++step) {
    time_ns += step % 16 == 0 ? 40'011 : 17 + 13 * (step % 97);
    translated.soc.advance(time_ns);
    interpreted.soc.advance(time_ns);
    ASSERT_TRUE(mebots::test::same_state(translated.soc.hart(), interpreted.soc.hart())) << "at " << time_ns << " ns";
    if (step % 128 != 0) continue;  // memory and devices take longer to compare
    ASSERT_TRUE(mebots::test::same_state(translated.soc, interpreted.soc)) << "at " << time_ns << " ns";
  }
  EXPECT_GT(translated.soc.hart().code().instructions_translated(), 0U);
  EXPECT_GT(translated.soc.hart().reg(24), 1000U) << "interrupts";
  EXPECT_GT(translated.soc.hart().reg(23), 1000U) << "calls";
}

INSTANTIATE_TEST_SUITE_P(WaitCycles, VirtRam, testing::Values(0, 8));

TEST(Virt, TimerWakesASleepingCoreAtItsTick) {
  VirtSystem system(timer_program(500, "wfi\n1: j 1b"));
  system.soc.run_cycles(100'000);
  EXPECT_EQ(system.soc.end(), End::exited);
  // Fifteen instructions follow the wake-up.
  EXPECT_GE(system.soc.now(), 50'000'000);
  EXPECT_LT(system.soc.now(), 50'000'000 + 400'000);
  EXPECT_GT(system.soc.sleep_time(), 45'000'000);
}

TEST(Virt, MtimeCountsTenMegahertzOfTheCoresTime) {
  VirtSystem system(R"(
_start: li t0, COUNT
    li t2, RESULTS
    csrr a0, mcycle
    lw a1, 0(t0)
    .rept 173
    nop
    .endr
    csrr a2, mcycle
    lw a3, 0(t0)
    sw a0, 0(t2)
    sw a1, 4(t2)
    sw a2, 8(t2)
    sw a3, 12(t2)
1:  j 1b
)");
  system.soc.run_cycles(2'000);
  // Reading mcycle takes four cycles, and the load starts after it. Ten cycles of 100 MHz are a tick.
  EXPECT_EQ(system.result(1), (system.result(0) + 4) / 10);
  EXPECT_EQ(system.result(3), (system.result(2) + 4) / 10);
  EXPECT_GT(system.result(3), 17U);
}

TEST(Virt, RegisterTimeShowsMtimeAndSatpIsBare) {
  VirtSystem system(R"(
_start: csrw satp, zero
    li t0, COUNT
    li t2, RESULTS
    li t1, 7
    sw t1, 4(t0)
    .rept 500
    nop
    .endr
    rdtime a0
    rdtimeh a1
    lw a2, 0(t0)
    li a3, -1
    csrw satp, a3
    csrr a3, satp
    sw a0, 0(t2)
    sw a1, 4(t2)
    sw a2, 8(t2)
    sw a3, 12(t2)
1:  j 1b
)");
  system.soc.run_cycles(2'000);
  EXPECT_GE(system.result(0), 50U);
  EXPECT_LE(system.result(2) - system.result(0), 1U);
  EXPECT_EQ(system.result(1), 7U);
  EXPECT_EQ(system.result(3), 0U);
  EXPECT_TRUE(system.faults.empty());
  VirtSystem writes("_start: nop\n.word 0xc0151073\n1: j 1b");  // csrw time, a0
  writes.soc.run_cycles(100);
  EXPECT_EQ(writes.faults.size(), 1U);
}

TEST(Virt, MtimeCanBeWrittenAndMovesTheNextInterrupt) {
  VirtSystem system("_start: j _start");
  auto& timer = system.device("mtimer");
  constexpr Picoseconds kTick = 100'000;
  store(timer, 0x7ff8, 5, 1'000 * kTick);
  store(timer, 0x7ffc, 0, 1'000 * kTick);
  EXPECT_EQ(load(timer, 0x7ff8, 1'007 * kTick), 12U);
  store(timer, 0x4, 0, 1'007 * kTick);
  store(timer, 0x0, 20, 1'007 * kTick);
  EXPECT_FALSE(timer.interrupt());
  EXPECT_EQ(timer.next_event(), 1'015 * kTick);
  timer.advance(timer.next_event());
  EXPECT_TRUE(timer.interrupt());
  store(timer, 0x0, 0xffffffff, 1'016 * kTick);
  EXPECT_FALSE(timer.interrupt()) << "a later compare takes the line down";
  store(timer, 0x7ffc, 0xffffffff, 1'016 * kTick);
  EXPECT_TRUE(timer.interrupt());
  EXPECT_EQ(load(timer, 0x7ffc, 1'016 * kTick), 0xffffffffU);
  EXPECT_EQ(load(timer, 0x8), 0U) << "hart 1 does not exist";
}

TEST(Virt, SoftwareInterruptIsBitZeroOfMsip) {
  VirtSystem system(R"(
_start: la t0, handler
    csrw mtvec, t0
    csrwi mie, 8
    csrsi mstatus, 8
    li s0, MSWI
    li t1, 0xfffffffe
    sw t1, 0(s0)
    lw s1, 0(s0)
    li t1, 1
    sw t1, 0(s0)
missed: nop
1:  j 1b
    .balign 4
handler: csrr a0, mcause
    csrr a1, mepc
    la a2, missed
    sub a1, a1, a2
    sw zero, 0(s0)
    lw a3, 0(s0)
    li t0, RESULTS
    sw a0, 0(t0)
    sw a1, 4(t0)
    sw s1, 8(t0)
    sw a3, 12(t0)
2:  j 2b
)");
  system.soc.run_cycles(2'000);
  EXPECT_EQ(system.result(0), 0x80000003U);
  EXPECT_EQ(system.result(1), 0U) << "the instruction after the store does not run first";
  EXPECT_EQ(system.result(2), 0U) << "bits 31 to 1 are zero";
  EXPECT_EQ(system.result(3), 0U);
  EXPECT_FALSE(system.device("mswi").interrupt());
}

class Plic : public testing::Test {
 protected:
  static constexpr std::uint32_t kPending = 0x1000;
  static constexpr std::uint32_t kEnable = 0x2000;
  static constexpr std::uint32_t kThreshold = 0x200000;
  static constexpr std::uint32_t kClaim = 0x200004;

  void enable(unsigned source, std::uint32_t priority) {
    store(plic_, 4 * source, priority);
    const auto word = kEnable + source / 32 * 4;
    store(plic_, word, load(plic_, word) | 1U << source % 32);
  }
  void level(unsigned source, bool up) { dynamic_cast<InterruptController&>(plic_).set_source(source, up); }

  VirtSystem system_{"_start: j _start"};
  Device& plic_ = system_.device("plic");
};

TEST_F(Plic, ClaimsTheHighestPriorityAndOfEqualOnesTheLowestNumber) {
  enable(3, 2);
  enable(10, 5);
  enable(40, 5);
  enable(100, 1);
  for (const unsigned source : {100U, 40U, 10U, 3U, 7U}) level(source, true);
  EXPECT_TRUE(plic_.interrupt());
  EXPECT_EQ(load(plic_, kPending), 1U << 3 | 1U << 7 | 1U << 10);
  EXPECT_EQ(load(plic_, kPending + 4), 1U << 8);
  std::vector<std::uint32_t> claimed;
  for (int i = 0; i < 5; ++i) claimed.push_back(load(plic_, kClaim));
  EXPECT_THAT(claimed, ElementsAre(10U, 40U, 3U, 100U, 0U)) << "7 is not enabled";
  EXPECT_FALSE(plic_.interrupt());
}

TEST_F(Plic, ThresholdMasksTheLineButNotTheClaim) {
  enable(10, 3);
  level(10, true);
  store(plic_, kThreshold, 3);
  EXPECT_FALSE(plic_.interrupt());
  store(plic_, kThreshold, 2);
  EXPECT_TRUE(plic_.interrupt());
  store(plic_, kThreshold, 7);
  EXPECT_FALSE(plic_.interrupt());
  EXPECT_EQ(load(plic_, kClaim), 10U);
}

TEST_F(Plic, PriorityZeroNeverInterrupts) {
  enable(10, 0);
  level(10, true);
  EXPECT_FALSE(plic_.interrupt());
  EXPECT_EQ(load(plic_, kClaim), 0U);
}

TEST_F(Plic, ASourceThatStaysUpComesAgainAfterItsCompletion) {
  enable(10, 1);
  level(10, true);
  EXPECT_EQ(load(plic_, kClaim), 10U);
  level(10, true);
  EXPECT_FALSE(plic_.interrupt()) << "the gateway waits for the completion";
  store(plic_, kClaim, 11);
  EXPECT_FALSE(plic_.interrupt()) << "the completion of another source is ignored";
  store(plic_, kClaim, 10);
  EXPECT_TRUE(plic_.interrupt());
  EXPECT_EQ(load(plic_, kClaim), 10U);
  level(10, false);
  store(plic_, kClaim, 10);
  EXPECT_FALSE(plic_.interrupt());
}

TEST_F(Plic, ARequestStaysPendingWhenItsSourceFalls) {
  enable(10, 1);
  level(10, true);
  level(10, false);
  EXPECT_TRUE(plic_.interrupt());
  EXPECT_EQ(load(plic_, kClaim), 10U);
}

TEST_F(Plic, OtherContextsAndSourceZeroReadZero) {
  store(plic_, kEnable, 0xffffffff);
  EXPECT_EQ(load(plic_, kEnable), 0xfffffffeU);
  store(plic_, 0, 7);
  EXPECT_EQ(load(plic_, 0), 0U);
  store(plic_, kEnable + 0x80, 0xffffffff);  // S mode of hart 0
  EXPECT_EQ(load(plic_, kEnable + 0x80), 0U);
  store(plic_, kThreshold + 0x1000, 5);
  EXPECT_EQ(load(plic_, kThreshold + 0x1000), 0U);
  store(plic_, 4 * 10, 0xff);
  EXPECT_EQ(load(plic_, 4 * 10), 7U) << "a priority has three bits";
}

class Uart : public testing::Test {
 protected:
  static constexpr std::uint32_t kData = 0;
  static constexpr std::uint32_t kIer = 1;
  static constexpr std::uint32_t kIir = 2;
  static constexpr std::uint32_t kLcr = 3;
  static constexpr std::uint32_t kMcr = 4;
  static constexpr std::uint32_t kLsr = 5;
  static constexpr std::uint32_t kMsr = 6;

  explicit Uart(std::string_view input = "abcdefghijklmnopqrstuvwxyz") : system_("_start: j _start", {}, input) {}

  /// Sets 115 200 baud and eight data bits. A character takes 10 x 16 x 2 / 3.6864 MHz = 86.8 us.
  void set_115200() {
    store(uart_, kLcr, 0x83);
    store(uart_, kData, 2);
    store(uart_, kIer, 0);
    store(uart_, kLcr, 0x03);
  }
  static constexpr Picoseconds kCharacter = std::int64_t{320} * 10'000'000'000 / 36'864;

  void run_to(Picoseconds time) {
    while (uart_.next_event() <= time) uart_.advance(uart_.next_event());
  }

  VirtSystem system_;
  Device& uart_ = system_.device("uart");
};

TEST_F(Uart, TransmitsAtOnceAndIsAlwaysEmpty) {
  for (const char character : std::string("Hi\n")) {
    EXPECT_EQ(load(uart_, kLsr) & 0x60U, 0x60U);
    store(uart_, kData, static_cast<std::uint32_t>(character));
  }
  EXPECT_EQ(system_.output, "Hi\n");
}

TEST_F(Uart, TakesNoInputBeforeTheProgramReads) {
  set_115200();
  run_to(1'000 * kCharacter);
  EXPECT_TRUE(system_.asked_at.empty());
  EXPECT_EQ(load(uart_, kLsr, 7), 0x60U);
  run_to(3 * kCharacter + 7);
  EXPECT_THAT(system_.asked_at, ElementsAre(kCharacter + 7)) << "without FIFO there is room for one byte";
  EXPECT_EQ(load(uart_, kLsr, 3 * kCharacter), 0x61U);
  EXPECT_EQ(load(uart_, kData, 3 * kCharacter), 'a');
  EXPECT_EQ(load(uart_, kLsr, 3 * kCharacter), 0x60U);
  run_to(4 * kCharacter);
  EXPECT_EQ(load(uart_, kData, 4 * kCharacter), 'b') << "a character's time after there was room";
}

TEST_F(Uart, FifoHoldsSixteenBytesAndLosesNone) {
  set_115200();
  store(uart_, kIir, 0x01);
  load(uart_, kLsr);
  run_to(40 * kCharacter);
  EXPECT_EQ(system_.asked_at.size(), 16U);
  std::string read;
  Picoseconds now = 40 * kCharacter;
  for (int i = 0; i < 26; ++i) {
    read += static_cast<char>(load(uart_, kData, now));
    now += kCharacter;
    run_to(now);
  }
  EXPECT_EQ(read, "abcdefghijklmnopqrstuvwxyz");
  EXPECT_EQ(load(uart_, kLsr, now), 0x60U);
}

TEST_F(Uart, InterruptsAtItsTriggerLevelOrWhenNothingMoreComes) {
  set_115200();
  store(uart_, kIir, 0x81);  // FIFO, level 8
  EXPECT_EQ(load(uart_, kIir), 0xc1U);
  store(uart_, kIer, 1);
  run_to(7 * kCharacter);
  EXPECT_FALSE(uart_.interrupt());
  run_to(8 * kCharacter);
  EXPECT_TRUE(uart_.interrupt());
  EXPECT_EQ(load(uart_, kIir), 0xc4U);
  EXPECT_EQ(load(uart_, kData, 8 * kCharacter), 'a');
  EXPECT_FALSE(uart_.interrupt()) << "seven are left";
}

class ShortInput : public Uart {
 protected:
  ShortInput() : Uart("xy") {}
};

TEST_F(ShortInput, TimesOutAfterFourCharacters) {
  set_115200();
  store(uart_, kIir, 0x81);
  store(uart_, kIer, 1);
  run_to(6 * kCharacter - 1);
  EXPECT_FALSE(uart_.interrupt());
  run_to(6 * kCharacter);
  EXPECT_TRUE(uart_.interrupt()) << "four characters after the second byte";
  EXPECT_EQ(load(uart_, kIir), 0xccU);
  load(uart_, kData, 6 * kCharacter);
  EXPECT_FALSE(uart_.interrupt());
  run_to(10 * kCharacter);
  EXPECT_TRUE(uart_.interrupt()) << "and four after the read, for the byte that is left";
  EXPECT_EQ(load(uart_, kData, 10 * kCharacter), 'y');
  EXPECT_EQ(uart_.next_event(), kNever) << "the input has ended";
}

TEST_F(Uart, TransmitterInterruptIsClearedByReadingIir) {
  store(uart_, kIer, 2);
  EXPECT_TRUE(uart_.interrupt()) << "the transmitter is empty";
  EXPECT_EQ(load(uart_, kIir), 0x02U);
  EXPECT_EQ(load(uart_, kIir), 0x01U);
  EXPECT_FALSE(uart_.interrupt());
  store(uart_, kData, 'x');
  EXPECT_EQ(load(uart_, kIir), 0x02U);
}

TEST_F(Uart, LoopReturnsBytesAndModemLines) {
  store(uart_, kIir, 0x01);
  EXPECT_EQ(load(uart_, kMsr), 0xb0U);
  store(uart_, kMcr, 0x10 | 0x0a);  // loop, OUT2, RTS
  store(uart_, kData, 'q');
  EXPECT_EQ(load(uart_, kData), 'q');
  EXPECT_EQ(system_.output, "");
  EXPECT_EQ(load(uart_, kMsr), 0x92U) << "DCD from OUT2, CTS from RTS; DSR has changed";
  EXPECT_EQ(load(uart_, kMsr), 0x90U);
}

TEST_F(Uart, KeepsDivisorControlAndScratch) {
  store(uart_, kLcr, 0x9b);
  store(uart_, kData, 0x34);
  store(uart_, kIer, 0x12);
  EXPECT_EQ(load(uart_, kData), 0x34U);
  EXPECT_EQ(load(uart_, kIer), 0x12U);
  EXPECT_EQ(load(uart_, kLcr), 0x9bU);
  store(uart_, 7, 0xa5);
  EXPECT_EQ(load(uart_, 7), 0xa5U);
}

/// Echoes each byte from the handler of the UART's interrupt, through the PLIC; 'q' ends the program with code 7.
constexpr std::string_view kEcho = R"(
_start: la t0, handler
    csrw mtvec, t0
    li t0, PLIC
    li t1, 1
    sw t1, 40(t0)
    li t2, PLIC + 0x2000
    li t1, 1 << 10
    sw t1, 0(t2)
    li s0, UART
    li t1, 1
    sb t1, 2(s0)
    sb t1, 1(s0)
    li t0, 1 << 11
    csrw mie, t0
    csrsi mstatus, 8
1:  wfi
    j 1b
    .balign 4
handler: li s1, PLIC + 0x200000
    lw s2, 4(s1)
2:  lbu t0, 5(s0)
    andi t0, t0, 1
    beqz t0, 3f
    lbu t0, 0(s0)
    sb t0, 0(s0)
    li t1, 'q'
    bne t0, t1, 2b
    li t0, FINISHER
    li t1, 0x73333
    sw t1, 0(t0)
3:  sw s2, 4(s1)
    li t0, RESULTS
    lw t1, 0(t0)
    addi t1, t1, 1
    sw t1, 0(t0)
    sw s2, 4(t0)
    mret
)";

TEST(Virt, EchoesItsInputByInterruptsThroughThePlic) {
  VirtSystem system(kEcho, {}, "hello, q");
  system.soc.run_cycles(1'000'000);
  EXPECT_EQ(system.output, "hello, q");
  EXPECT_EQ(system.soc.end(), End::exited);
  EXPECT_EQ(system.soc.exit_code(), 7);
  EXPECT_EQ(system.result(1), 10U) << "the source of the interrupt";
  EXPECT_EQ(system.result(0), 7U) << "one interrupt per byte before the last";
  // After reset, a character has 7 bits of 16 x 12 / 3.6864 MHz. Eight characters arrive, the first one after the
  // interrupt is enabled.
  EXPECT_NEAR(static_cast<double>(system.soc.now()), 8 * 7 * 16 * 12 / 3.6864e6 * 1e12, 2e6);
}

TEST(Virt, ARestoredStateContinuesWithTheSameBits) {
  VirtSystem straight(kEcho, {}, "hello, q");
  straight.soc.run_cycles(1'000'000);
  VirtSystem first(kEcho, {}, "hello, q");
  first.soc.run_cycles(300);
  first.soc.run_cycles(Soc::kWithoutEnd, 1'200'000'000);  // 1.2 ms: three bytes of 365 us have arrived
  EXPECT_EQ(first.output, "hel");
  const auto state = state::save(first.soc);
  VirtSystem second(kEcho, {}, "lo, q");
  state::restore(second.soc, state);
  second.soc.run_cycles(1'000'000);
  EXPECT_EQ(second.output, "lo, q");
  EXPECT_EQ(second.soc.now(), straight.soc.now());
  EXPECT_EQ(second.soc.hart().counters().cycles, straight.soc.hart().counters().cycles);
  EXPECT_TRUE(state::save(second.soc) == state::save(straight.soc));
}

TEST(Virt, AStateHoldsOnlyThePagesThatAProgramHasWritten) {
  constexpr std::string_view kStores =
      "_start: li a0, 0x84000ffc\nsw a0, 0(a0)\nli a1, 0x87fffffc\nsw a1, 0(a1)\n1: j 1b";
  VirtSystem first(kStores);
  first.soc.run_cycles(1'000);
  const auto state = state::save(first.soc);
  EXPECT_LT(state.size(), 100'000U) << "of 128 MiB of RAM";
  VirtSystem second("_start: li a0, 0x85000000\nsw a0, 0(a0)\n1: j 1b");
  second.soc.run_cycles(1'000);
  state::restore(second.soc, state);
  const auto word_at = [&](std::uint32_t address) {
    std::uint32_t word = 1;
    EXPECT_TRUE(second.soc.memory().read(address, {reinterpret_cast<std::uint8_t*>(&word), sizeof word}));
    return word;
  };
  EXPECT_EQ(word_at(0x84000ffc), 0x84000ffcU);
  EXPECT_EQ(word_at(0x87fffffc), 0x87fffffcU);
  EXPECT_EQ(word_at(0x85000000), 0U) << "what the other program has written is gone";
  EXPECT_TRUE(state::save(second.soc) == state);
}

TEST(Virt, ARunEndsAtItsTimeAndAnEndlessSleepBeforeIt) {
  VirtSystem runs("_start: j _start");
  runs.soc.run_cycles(~std::uint64_t{0}, 5'000'000);
  EXPECT_EQ(runs.soc.now(), 5'000'000);
  EXPECT_EQ(runs.soc.hart().counters().instructions, 251U) << "a jump to itself takes two cycles of 10 ns";
  VirtSystem sleeps("_start: wfi\nj _start");
  sleeps.soc.run_cycles(~std::uint64_t{0}, 5'000'000);
  EXPECT_TRUE(sleeps.soc.sleeps_for_good());
  EXPECT_LT(sleeps.soc.now(), 100'000);
}

TEST(Virt, NamesWhatItLacks) {
  struct Case {
    std::uint32_t address;
    const char* says;
  };
  for (const auto& [address, says] : std::initializer_list<Case>{
           {0x10001000, "QEMU's virtio devices, which board virt lacks"},
           {0x00101000, "QEMU's Goldfish RTC"},
           {0x20000000, "QEMU's flash"},
           {0x10000008, "board virt has nothing at 0x10000008; its memories are 0x80000000 to 0x87ffffff"},
           {0x70000000, "QEMU's PCIe memory"}}) {
    VirtSystem system(fmt::format("_start: li a0, {}\nlw a1, 0(a0)\n1: j 1b", address));
    system.soc.run_cycles(1'000);
    ASSERT_EQ(system.faults.size(), 1U);
    EXPECT_THAT(system.faults[0], HasSubstr("load access fault (mcause 5"));
    EXPECT_THAT(system.faults[0], HasSubstr(says));
  }
  VirtSystem narrow("_start: li a0, MSWI\nlb a1, 0(a0)\n1: j 1b");
  narrow.soc.run_cycles(1'000);
  ASSERT_EQ(narrow.faults.size(), 1U);
  EXPECT_THAT(narrow.faults[0], HasSubstr("device mswi has no register for this access at its offset 0x0"));
}

TEST(Virt, RefusesAnInterruptThatItsControllerLacks) {
  auto board = read_board(MEBOTS_SOURCE_DIR "/configs/boards/virt.json");
  const auto refusal = [&] {
    try {
      const Soc soc(board, gap8(), {}, assemble("_start: j _start"), {});
      return std::string();
    } catch (const Error& error) {
      return std::string(error.what());
    }
  };
  auto& uart = board.devices.back();
  uart.interrupt = 128;
  EXPECT_THAT(refusal(), HasSubstr("plic has no interrupt source 128; the last one is 127"));
  uart.interrupt_controller = "mtimer";
  EXPECT_THAT(refusal(), HasSubstr("is a device of another kind"));
}

}  // namespace
}  // namespace mebots::soc::test
