// SPDX-License-Identifier: Apache-2.0
// Tests time and energy per function and call stack. Each function has its own time, and the sum of all parts is
// exactly the total.
#include "observe/profile.hpp"

#include "board_system.hpp"
#include "mebots/state/save.hpp"
#include "support.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <map>

namespace mebots::soc::test {
namespace {

using observe::CallTree;
using observe::Cost;
using observe::Profile;

/// Returns the names of a stack's frames, the outermost frame first, such as "main;leaf".
std::string stack_text(Profile& profile, std::size_t node) {
  const auto& nodes = profile.hart(0).tree().nodes();
  std::string text;
  for (; node != CallTree::kRoot; node = nodes[node].parent) {
    const auto& name = profile.functions().name(nodes[node].place);
    text = text.empty() ? name : fmt::format("{};{}", name, text);
  }
  return text;
}

/// Runs a program on the board with a profile. Contains the inclusive cost and the calls of each stack.
struct Profiled {
  explicit Profiled(std::string_view text, std::int64_t end_ns = 0, std::string_view file = "p.json",
                    bool translate = true)
      : system(fmt::format("{}\n{}", text, kFunctions), settings(translate)) {
    Profile profile("--profile", folder / file, system.soc);
    auto& fabric_controller = profile.hart(0);
    system.soc.observe(0, &fabric_controller);
    if (end_ns > 0) {
      system.soc.advance(end_ns);
    } else {
      system.soc.run_cycles(1'000'000);
    }
    translated = system.soc.hart().code().is_translated();
    system.soc.observe(0, nullptr);
    profile.finish();
    written = read_file(folder / file);
    total = fabric_controller.total();
    const auto inclusive = fabric_controller.tree().inclusive();
    for (std::size_t i = 1; i < inclusive.size(); ++i) {
      const auto stack = stack_text(profile, i);
      stacks[stack] += inclusive[i];
      calls[stack] += fabric_controller.tree().nodes()[i].calls;
    }
  }

  static Settings settings(bool translate) {
    Settings settings;
    settings.translate = translate;
    return settings;
  }

  static constexpr std::string_view kFunctions = R"(
    .macro function name
    .globl \name
    .type \name, @function
    .endm
    .section .text.functions, "ax"
    function leaf
leaf: addi a0, a0, 1
    mul a0, a0, a0
    ret
    .size leaf, . - leaf
    function middle
middle: addi sp, sp, -16
    sw ra, 12(sp)
    call leaf
    call leaf
    lw ra, 12(sp)
    addi sp, sp, 16
    ret
    .size middle, . - middle
    function tail
tail: addi a1, a1, 1
    j leaf
    .size tail, . - tail
    function down
down: addi sp, sp, -16
    sw ra, 12(sp)
    addi a5, a5, -1
    beqz a5, 1f
    call down
1:  lw ra, 12(sp)
    addi sp, sp, 16
    ret
    .size down, . - down
    function finish
finish: li t0, POWER_MANAGER_BASE
    sw zero, POWER_MANAGER_EXIT_OFFSET(t0)
    nop
    .size finish, . - finish
    .text
)";

  Folder folder;
  BoardSystem system;
  std::string written;
  bool translated = false;
  Cost total;
  std::map<std::string, Cost> stacks;
  std::map<std::string, std::uint64_t> calls;
};

void expect_whole(const Profiled& run) {
  const auto& counters = run.system.soc.hart().counters();
  EXPECT_EQ(run.total.cycles, static_cast<std::int64_t>(counters.cycles));
  EXPECT_EQ(run.total.instructions, static_cast<std::int64_t>(counters.instructions));
  EXPECT_EQ(run.total.time_ps, run.system.soc.now());
  EXPECT_EQ(run.total.energy_fj, std::llround(run.system.soc.energy().total_j() * 1e15));
}

TEST(Profile, SplitsTheRunByCallStackAndAddsUpExactly) {
  const Profiled run(
      ".globl _start\n.type _start, @function\n_start: li sp, 0x1C070000\ncall middle\ncall leaf\nj finish\n"
      ".size _start, . - _start\n");
  expect_whole(run);
  EXPECT_EQ(run.calls.at("_start;middle"), 1U);
  EXPECT_EQ(run.calls.at("_start;middle;leaf"), 2U);
  EXPECT_EQ(run.calls.at("_start;leaf"), 1U);
  EXPECT_EQ(run.stacks.at("_start;middle;leaf").instructions, 6);
  EXPECT_EQ(run.stacks.at("_start;leaf").instructions, 3);
  EXPECT_EQ(run.stacks.at("_start;middle").instructions, 6 + 2 + 2 * 2 + 3) << "call is auipc and jalr";
  EXPECT_EQ(run.stacks.at("_start;middle;leaf").energy_fj > 0, true);
}

TEST(Profile, ReplacesTheFrameAtATailCall) {
  const Profiled run(
      ".globl _start\n.type _start, @function\n_start: li sp, 0x1C070000\ncall tail\nj finish\n.size _start, . - "
      "_start\n");
  expect_whole(run);
  EXPECT_EQ(run.stacks.at("_start;tail").instructions, 2);
  EXPECT_EQ(run.stacks.at("_start;leaf").instructions, 3) << "not below tail, which has gone";
  EXPECT_EQ(run.stacks.count("_start;tail;leaf"), 0U);
}

TEST(Profile, HasAFrameForEveryLevelOfRecursion) {
  const Profiled run(
      ".globl _start\n.type _start, @function\n_start: li sp, 0x1C070000\nli a5, 4\ncall down\nj finish\n"
      ".size _start, . - _start\n");
  expect_whole(run);
  EXPECT_EQ(run.calls.count("_start;down;down;down;down"), 1U);
  EXPECT_EQ(run.calls.count("_start;down;down;down;down;down"), 0U);
}

/// A program that sleeps until the timer has reached 1 ms.
constexpr std::string_view kSleepsUntilATimer = R"(
    .globl _start
    .type _start, @function
_start: la t0, handler
    csrw mtvec, t0
    li t0, TIMER_BASE
    li t1, 1000000
    sw t1, TIMER_COMPARE_LO_OFFSET(t0)
    sw zero, TIMER_COMPARE_HI_OFFSET(t0)
    li t1, 1 << TIMER_INTERRUPT
    csrw mie, t1
    csrwi mstatus, 8
    wfi
    nop
    j finish
    .size _start, . - _start
    .balign 4
    .globl handler
    .type handler, @function
handler: li t1, -1
    sw t1, TIMER_COMPARE_HI_OFFSET(t0)
    sw t1, TIMER_COMPARE_LO_OFFSET(t0)
    mret
    .size handler, . - handler
)";

TEST(Profile, GivesInterruptsAndSleepFramesOfTheirOwn) {
  const Profiled run(kSleepsUntilATimer, 2'000'000);
  EXPECT_EQ(run.total.time_ps, 2'000'000'000) << "to the end of the step, asleep for good after finish";
  const auto& asleep = run.stacks.at("_start;[asleep]");
  EXPECT_EQ(asleep.cycles, 0);
  EXPECT_NEAR(static_cast<double>(asleep.time_ps), 1e9, 1e6) << "1 ms less the first instructions";
  EXPECT_GT(asleep.energy_fj, 0) << "leakage goes on";
  EXPECT_EQ(run.stacks.at("_start;[interrupt 7];handler").instructions, 4);
  EXPECT_EQ(run.stacks.at("_start;[interrupt 7]"), run.stacks.at("_start;[interrupt 7];handler"))
      << "the cycles of getting there are the handler's";
  EXPECT_EQ(run.calls.count("finish"), 1U) << "after the interrupt the stack is as before";
}

TEST(Profile, HearsThatACoreWokeWhichSleptInARestoredState) {
  const auto text = fmt::format("{}\n{}", kSleepsUntilATimer, Profiled::kFunctions);
  BoardSystem earlier(text);
  earlier.soc.advance(500'000);
  ASSERT_TRUE(earlier.soc.hart().sleeping());
  const auto state = state::save(earlier.soc);

  const Folder folder;
  BoardSystem system(text);
  Profile profile("--profile", folder / "p.json", system.soc);
  system.soc.observe(0, &profile.hart(0));
  state::restore(system.soc, state);
  profile.restored();
  system.soc.advance(2'000'000);
  system.soc.observe(0, nullptr);
  profile.finish();
  std::map<std::string, Cost> stacks;
  const auto& nodes = profile.hart(0).tree().nodes();
  for (std::size_t i = 1; i < nodes.size(); ++i) stacks[stack_text(profile, i)] += nodes[i].self;
  EXPECT_EQ(stacks.count("_start;[interrupt 7];handler"), 1U);
  EXPECT_EQ(stacks.count("_start;[asleep];[interrupt 7]"), 0U);
  EXPECT_NEAR(static_cast<double>(stacks.at("_start;[asleep]").time_ps), 0.5e9, 1e6) << "from 0.5 ms to 1 ms";
}

/// The program executes the following 3000 times, with occasional interrupts: direct calls, calls by a register, tail
/// calls, a jump table, code that continues into the next function, and recursion.
TEST(Profile, IsTheSameForTranslatedAndInterpretedCode) {
  constexpr std::string_view kProgram = R"(
    .globl _start
    .type _start, @function
_start: li sp, 0x1C070000
    la t0, on_timer
    csrw mtvec, t0
    li t0, TIMER_BASE
    li t1, 100000
    sw t1, TIMER_COMPARE_LO_OFFSET(t0)
    sw zero, TIMER_COMPARE_HI_OFFSET(t0)
    li t1, 1 << TIMER_INTERRUPT
    csrw mie, t1
    csrwi mstatus, 8
    li s0, 3000
    la s1, leaf
    la s2, table
again: call middle
    jalr s1
    call tail
    call runs_on
    li a5, 3
    call down
    andi a3, s0, 4
    add a3, a3, s2
    lw a3, 0(a3)
    call by_table
    addi s0, s0, -1
    bnez s0, again
    j finish
    .size _start, . - _start
    .globl on_timer
    .balign 4
    .type on_timer, @function
on_timer: sw t1, -64(sp)
    li t1, TIMER_BASE
    sw t1, -68(sp)
    lw t1, TIMER_COMPARE_LO_OFFSET(t1)
    addi t1, t1, 2000
    sw t0, -72(sp)
    li t0, TIMER_BASE
    sw t1, TIMER_COMPARE_LO_OFFSET(t0)
    lw t0, -72(sp)
    lw t1, -64(sp)
    mret
    .size on_timer, . - on_timer
    .globl runs_on
    .type runs_on, @function
runs_on: addi a2, a2, 1
    addi a2, a2, 2
    .size runs_on, . - runs_on
    .globl goes_on
    .type goes_on, @function
goes_on: addi a2, a2, 3
    ret
    .size goes_on, . - goes_on
    .globl by_table
    .type by_table, @function
by_table: jr a3
    .size by_table, . - by_table
    .data
    .balign 4
table: .word leaf, tail
    .text
)";
  const Profiled interpreted(kProgram, 0, "p.json", false);
  const Profiled translated(kProgram, 0, "p.json", true);
  EXPECT_FALSE(interpreted.translated);
  EXPECT_TRUE(translated.translated);
  expect_whole(interpreted);
  expect_whole(translated);
  EXPECT_EQ(translated.calls, interpreted.calls);
  ASSERT_EQ(translated.stacks.size(), interpreted.stacks.size());
  EXPECT_EQ(translated.calls.at("_start;goes_on"), 3000U);
  EXPECT_GT(translated.calls.at("_start;middle;leaf;[interrupt 7];on_timer"), 0U);
  for (const auto& [stack, cost] : interpreted.stacks) {
    const auto& other = translated.stacks.at(stack);
    EXPECT_EQ(other.cycles, cost.cycles) << stack;
    EXPECT_EQ(other.instructions, cost.instructions) << stack;
    EXPECT_EQ(other.time_ps, cost.time_ps) << stack;
    // Each of about 100,000 steps rounds up or down to a whole number of femtojoules.
    EXPECT_NEAR(static_cast<double>(other.energy_fj), static_cast<double>(cost.energy_fj), 1e5) << stack;
  }
}

/// Returns the profile of a program that sleeps until 1 ms. The run consists of `steps` steps.
nlohmann::json windowed(int steps, std::int64_t step_ns, Cost& total) {
  const auto text = fmt::format("{}\n{}", kSleepsUntilATimer, Profiled::kFunctions);
  const Folder folder;
  BoardSystem system(text);
  Profile profile("--profile", folder / "p.json", system.soc);
  system.soc.observe(0, &profile.hart(0));
  for (int i = 1; i <= steps; ++i) {
    system.soc.advance(i * step_ns);
    profile.stepped();
  }
  system.soc.observe(0, nullptr);
  profile.finish();
  total = profile.hart(0).total();
  return nlohmann::json::parse(read_file(folder / "p.json"))["mebots"];
}

/// Adds up cycles, ps and fJ of all windows.
Cost sum_of_windows(const nlohmann::json& written) {
  Cost sum;
  for (const auto& window : written["windows"]) {
    const auto& parts = window["parts"];
    for (std::size_t i = 0; i < parts.size(); i += 5) {
      sum.cycles += parts[i + 2].get<std::int64_t>();
      sum.time_ps += parts[i + 3].get<std::int64_t>();
      sum.energy_fj += parts[i + 4].get<std::int64_t>();
    }
  }
  return sum;
}

TEST(Profile, BySpansOfTimeAddsUpToTheWholeExactly) {
  Cost total;
  const auto written = windowed(20, 100'000, total);
  EXPECT_EQ(written["windows"].size(), 20U);
  EXPECT_EQ(written["windows"][3]["from"], 300'000.0);
  EXPECT_EQ(written["windows"][3]["to"], 400'000.0);
  const auto sum = sum_of_windows(written);
  EXPECT_EQ(sum.cycles, total.cycles);
  EXPECT_EQ(sum.time_ps, total.time_ps);
  EXPECT_EQ(sum.energy_fj, total.energy_fj);
  // From 300 to 400 us, the core only sleeps.
  EXPECT_EQ(written["windows"][3]["parts"].size(), 5U);
  EXPECT_EQ(written["windows"][3]["parts"][3], 100'000'000);
}

TEST(Profile, JoinsSpansOfALongRunWithoutLoss) {
  Cost total;
  const auto written = windowed(3000, 1000, total);
  EXPECT_LT(written["windows"].size(), observe::ProfileWindows::kMost);
  EXPECT_GT(written["windows"].size(), observe::ProfileWindows::kMost / 2);
  EXPECT_EQ(written["windows"][0]["to"], 4000.0) << "four steps in one";
  const auto sum = sum_of_windows(written);
  EXPECT_EQ(sum.time_ps, total.time_ps);
  EXPECT_EQ(sum.energy_fj, total.energy_fj);
}

TEST(Profile, ForSpeedscopeHoldsTheSameSums) {
  const Profiled run(
      ".globl _start\n.type _start, @function\n_start: li sp, 0x1C070000\ncall middle\nj finish\n.size _start, . - "
      "_start\n");
  const auto json = nlohmann::json::parse(run.written);
  ASSERT_EQ(json["profiles"].size(), 3U);
  const double ends[] = {static_cast<double>(run.total.time_ps) / 1e3, static_cast<double>(run.total.energy_fj) / 1e6,
                         static_cast<double>(run.total.cycles)};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& profile = json["profiles"][i];
    EXPECT_DOUBLE_EQ(profile["endValue"].get<double>(), ends[i]);
    // Checks the rules of speedscope: frames open and close like brackets, times never decrease, and all events are
    // inside the frames.
    std::vector<int> open;
    double last = 0;
    double self = 0;
    for (const auto& event : profile["events"]) {
      const auto at = event["at"].get<double>();
      EXPECT_GE(at, last);
      if (!open.empty()) self += at - last;
      last = at;
      const auto frame = event["frame"].get<int>();
      ASSERT_LT(frame, static_cast<int>(json["shared"]["frames"].size()));
      if (event["type"] == "O") {
        open.push_back(frame);
      } else {
        ASSERT_FALSE(open.empty());
        EXPECT_EQ(open.back(), frame);
        open.pop_back();
      }
    }
    EXPECT_TRUE(open.empty());
    EXPECT_NEAR(self, ends[i], 1e-9 * ends[i]) << "sums of doubles";
  }
}

TEST(Profile, ForCallgrindHoldsTheSameSums) {
  const Profiled run(
      ".globl _start\n.type _start, @function\n_start: li sp, 0x1C070000\ncall middle\nj finish\n.size _start, . - "
      "_start\n",
      0, "p.callgrind");
  EXPECT_THAT(run.written, testing::HasSubstr("events: Cycles Instructions Time_ps Energy_fJ\n"));
  std::istringstream lines(run.written);
  Cost self;
  bool inclusive = false;
  for (std::string line; std::getline(lines, line);) {
    Cost cost;
    int position = 0;
    if (std::istringstream(line) >> position >> cost.cycles >> cost.instructions >> cost.time_ps >> cost.energy_fj) {
      if (!inclusive) self += cost;
    }
    inclusive = line.starts_with("calls=");
  }
  EXPECT_EQ(self, run.total);
}

TEST(Profile, NeverShowsMarksOfCodeAndDataAndNamesNamelessCodeByItsAddress) {
  const Profiled run(
      ".globl _start\n.type _start, @function\n_start: li sp, 0x1C070000\nli t2, 0x1C020000\nli t1, 0x8082\n"
      "sh t1, 0(t2)\nfence.i\njalr t2\nj finish\n.size _start, . - _start\n");
  EXPECT_EQ(run.written.find("$x"), std::string::npos);
  EXPECT_EQ(run.written.find("$d"), std::string::npos);
  EXPECT_EQ(run.calls.count("_start;0x1c020000"), 1U);
}

}  // namespace
}  // namespace mebots::soc::test
