// SPDX-License-Identifier: Apache-2.0
// Tests the time from a picture to the set-points, and its parts.
#include "board_system.hpp"
#include "support/same_state.hpp"

#include "mebots/error.hpp"
#include "mebots/state/save.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace mebots::soc::test {
namespace {

constexpr Picoseconds kPsPerMs = 1'000'000'000;

CoreWork work(Picoseconds cluster_ms, Picoseconds controller_ms) {
  CoreWork done;
  done.cluster = cluster_ms * kPsPerMs;
  done.controller = controller_ms * kPsPerMs;
  return done;
}

PictureTimes picture(Picoseconds asked_ms, Picoseconds exposed_ms, Picoseconds read_out_ms, Picoseconds stored_ms) {
  return {asked_ms * kPsPerMs, exposed_ms * kPsPerMs, read_out_ms * kPsPerMs, stored_ms * kPsPerMs};
}

Picoseconds part(const Decision& decision, DecisionPart which) {
  return decision.parts[static_cast<std::size_t>(which)];
}

Picoseconds sum_of_parts(const Decision& decision) {
  return std::accumulate(decision.parts.begin(), decision.parts.end(), Picoseconds{0});
}

TEST(Decisions, DivideTheTimeFromTheRequestToTheSetPoints) {
  Decisions decisions("flight");
  decisions.picture_stored(picture(10, 12, 15, 30), work(100, 200));
  decisions.sent("flight", 50 * kPsPerMs, work(111, 203));
  EXPECT_EQ(decisions.count(), 0U) << "not published yet";
  decisions.published(52 * kPsPerMs);
  ASSERT_EQ(decisions.count(), 1U);
  const auto& last = decisions.last();
  EXPECT_EQ(part(last, DecisionPart::request), 2 * kPsPerMs);
  EXPECT_EQ(part(last, DecisionPart::exposure), 3 * kPsPerMs);
  EXPECT_EQ(part(last, DecisionPart::read_out), 15 * kPsPerMs);
  EXPECT_EQ(part(last, DecisionPart::wait), 6 * kPsPerMs);
  EXPECT_EQ(part(last, DecisionPart::inference), 11 * kPsPerMs);
  EXPECT_EQ(part(last, DecisionPart::deciding), 3 * kPsPerMs);
  EXPECT_EQ(part(last, DecisionPart::sending), 2 * kPsPerMs);
  EXPECT_EQ(last.latency, 42 * kPsPerMs);
  EXPECT_EQ(sum_of_parts(last), last.latency);
}

TEST(Decisions, BeginWithTheWaitOfAPictureThatArrivesDuringAnotherOne) {
  Decisions decisions("flight");
  decisions.picture_stored(picture(0, 0, 0, 10), work(0, 0));
  decisions.picture_stored(picture(12, 12, 12, 25), work(15, 0));
  decisions.sent("flight", 40 * kPsPerMs, work(30, 0));
  decisions.published(40 * kPsPerMs);
  decisions.sent("flight", 70 * kPsPerMs, work(58, 2));
  decisions.published(70 * kPsPerMs);
  ASSERT_EQ(decisions.count(), 2U);
  EXPECT_EQ(part(decisions.last(), DecisionPart::wait), 15 * kPsPerMs) << "from 25 to 40 ms: the one before";
  EXPECT_EQ(part(decisions.last(), DecisionPart::inference), 28 * kPsPerMs);
  EXPECT_EQ(decisions.last().latency, 58 * kPsPerMs);
  EXPECT_EQ(sum_of_parts(decisions.last()), decisions.last().latency);
  EXPECT_EQ(decisions.longest(), 58 * kPsPerMs);
  EXPECT_EQ(decisions.sum().latency, 98 * kPsPerMs);
}

TEST(Decisions, NeedAPictureAndTheBoardsSender) {
  Decisions decisions("flight");
  decisions.sent("flight", kPsPerMs, {});
  decisions.published(kPsPerMs);
  decisions.picture_stored(picture(1, 1, 1, 2), {});
  decisions.sent("other", 3 * kPsPerMs, {});
  decisions.published(3 * kPsPerMs);
  EXPECT_EQ(decisions.count(), 0U);
  Decisions none("");
  none.picture_stored(picture(1, 1, 1, 2), {});
  none.sent("", 3 * kPsPerMs, {});
  none.published(3 * kPsPerMs);
  EXPECT_EQ(none.count(), 0U);
}

TEST(Decisions, RefuseTimesOutOfOrder) {
  for (const auto& times : {picture(2, 1, 3, 4), picture(1, 3, 2, 4), picture(1, 2, 4, 3)}) {
    for (const auto* sender : {"flight", ""}) {
      Decisions decisions(sender);
      EXPECT_THROW(decisions.picture_stored(times, {}), Error);
      decisions.sent(sender, 5 * kPsPerMs, {});
      decisions.published(5 * kPsPerMs);
      EXPECT_EQ(decisions.count(), 0U) << "the picture is left out";
    }
  }
}

/// Requests a picture and sleeps until it arrives. Then the fabric controller executes 20,000 iterations. While it
/// sleeps, two cores of the cluster execute 40,000 iterations. Then the program sends set-points.
constexpr std::string_view kDecides = R"(
_start: li s0, CAMERA_BASE
    li s2, FLIGHT_BASE
    li s3, POWER_MANAGER_BASE
    li s4, EVENT_UNIT_BASE
    li a0, 0x1C040000
    sw a0, CAMERA_BUFFER_OFFSET(s0)
    li a0, 4096
    sw a0, CAMERA_BUFFER_SIZE_OFFSET(s0)
    li a0, 1 << CAMERA_INTERRUPT
    csrw mie, a0
    sw zero, FLIGHT_COMMIT_OFFSET(s2)   # rests on no picture
1:  li a0, 1
    sw a0, CAMERA_CONTROL_OFFSET(s0)
    wfi
    li a0, 2
    sw a0, CAMERA_STATUS_OFFSET(s0)
    li a1, 20000
2:  addi a1, a1, -1
    bnez a1, 2b
    la a0, core
    sw a0, POWER_MANAGER_CLUSTER_BOOT_OFFSET(s3)
    li a0, 1
    sw a0, POWER_MANAGER_CLUSTER_POWER_OFFSET(s3)
    li a0, 1
    sw a0, EVENT_UNIT_EVENT_MASK_OFFSET(s4)
    .insn i 0x03, 6, a0, EVENT_UNIT_EVENT_WAIT_OFFSET(s4)
    sw zero, POWER_MANAGER_CLUSTER_POWER_OFFSET(s3)
    sw zero, FLIGHT_COMMIT_OFFSET(s2)
    j 1b
core: li s4, EVENT_UNIT_BASE
    lw a0, EVENT_UNIT_CORE_ID_OFFSET(s4)
    li a1, 2
    bge a0, a1, 5f
    li a1, 40000
4:  addi a1, a1, -1
    bnez a1, 4b
    bnez a0, 5f
    li a1, 0x100
    sw a1, EVENT_UNIT_SOFTWARE_EVENT_OFFSET(s4)
5:  wfi
    j 5b
)";

/// Runs the system to `end_ms`. Each picture arrives at the first step after its request.
void fly(BoardSystem& system, std::int64_t end_ms, std::int64_t step_ns) {
  const std::vector<std::uint8_t> bytes(64 * 40, 7);
  for (std::int64_t now = system.soc.now() / kPsPerNs + step_ns; now <= end_ms * kMs; now += step_ns) {
    system.soc.advance(now);
    if (system.camera().wants(system.camera().requests())) system.camera().offer(bytes, system.soc.now());
  }
}

TEST(Decisions, HavePartsThatAddUpToTheLatency) {
  BoardSystem system(kDecides, {}, BoardSystem::narrow());
  fly(system, 100, 2 * kMs);
  const auto& decisions = system.soc.decisions();
  ASSERT_GE(decisions.count(), 4U);
  EXPECT_EQ(decisions.count(), static_cast<unsigned>(system.camera().requests()) - 1) << "the last one is under way";
  const auto& last = decisions.last();
  EXPECT_EQ(sum_of_parts(last), last.latency);
  EXPECT_EQ(sum_of_parts(decisions.sum()), decisions.sum().latency);
  EXPECT_GE(last.latency, 16'666'700'000);
  EXPECT_NEAR(static_cast<double>(part(last, DecisionPart::exposure) + part(last, DecisionPart::read_out)),
              16'666'700'000., 1.);
  // An iteration is an addition and a taken branch, which take 1 + 3 cycles.
  const auto cluster_ps = 40'000 * 4 * 1e12 / 87e6;
  EXPECT_NEAR(static_cast<double>(part(last, DecisionPart::inference)), cluster_ps, 0.01 * cluster_ps);
  const auto controller_ps = 20'000 * 4 * 1e12 / 100e6;
  EXPECT_NEAR(static_cast<double>(part(last, DecisionPart::deciding)), controller_ps, 0.02 * controller_ps);
  EXPECT_LT(part(last, DecisionPart::wait), 5 * kPsPerMs / 1000);
  EXPECT_NEAR(static_cast<double>(last.awake[0]), controller_ps, 0.02 * controller_ps);
  EXPECT_NEAR(static_cast<double>(last.awake[1]), cluster_ps, 0.01 * cluster_ps);
  EXPECT_NEAR(static_cast<double>(last.awake[2]), cluster_ps, 0.01 * cluster_ps);
  EXPECT_LT(last.awake[3], kPsPerMs / 100) << "it only finds that it has nothing to do";
}

TEST(Decisions, DependOnStepsInRequestAndSendingOnly) {
  BoardSystem coarse(kDecides, {}, BoardSystem::narrow());
  BoardSystem fine(kDecides, {}, BoardSystem::narrow());
  fly(coarse, 60, 2 * kMs);
  fly(fine, 60, kMs / 10);
  const auto& a = coarse.soc.decisions().last();
  const auto& b = fine.soc.decisions().last();
  for (const auto which : {DecisionPart::exposure, DecisionPart::read_out, DecisionPart::inference}) {
    EXPECT_NEAR(static_cast<double>(part(a, which)), static_cast<double>(part(b, which)), 1e5) << "a cycle or so";
  }
  EXPECT_LT(part(b, DecisionPart::request) + part(b, DecisionPart::sending), kPsPerMs / 2);
}

TEST(Decisions, ContinueFromAState) {
  BoardSystem straight(kDecides, {}, BoardSystem::narrow());
  BoardSystem other(kDecides, {}, BoardSystem::narrow());
  fly(straight, 29, kMs);
  const auto saved = state::save(straight.soc);
  fly(straight, 70, kMs);
  state::restore(other.soc, saved);
  fly(other, 70, kMs);
  EXPECT_EQ(other.soc.decisions().count(), straight.soc.decisions().count());
  EXPECT_EQ(other.soc.decisions().sum().parts, straight.soc.decisions().sum().parts);
  EXPECT_TRUE(mebots::test::same_state(straight.soc, other.soc));
}

}  // namespace
}  // namespace mebots::soc::test
