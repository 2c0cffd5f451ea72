// SPDX-License-Identifier: Apache-2.0
#include "debug/history.hpp"

#include "assembler.hpp"
#include "devices/core/chip_host.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <deque>
#include <numeric>
#include <vector>

namespace mebots::soc::test {
namespace {

using debug::History;
using testing::ElementsAre;

constexpr int kNo = ConsolePort::kNothingYet;
constexpr int kEnd = ConsolePort::kEnded;

/// Creates a chip whose time does not advance, its history, and a console on which input arrives late.
class HistoryTest : public testing::Test {
 protected:
  /// Calls input() `count` times and returns the results.
  std::vector<int> poll(int count) {
    std::vector<int> results;
    for (int i = 0; i < count; ++i) {
      results.push_back(history_.input([this] {
        ++reads_;
        if (live_.empty()) return kNo;
        const auto next = live_.front();
        live_.pop_front();
        return next;
      }));
    }
    return results;
  }

  Soc soc_{read_board(MEBOTS_SOURCE_DIR "/configs/boards/virt.json"), gap8(), {}, assemble("_start: j _start\n"), {}};
  History history_;
  std::deque<int> live_;
  int reads_ = 0;
};

TEST_F(HistoryTest, AReplayGetsEachByteAtTheCallThatReadIt) {
  live_ = {kNo, kNo, 'a', kNo, 'b', kNo, kNo};
  history_.record(soc_);
  EXPECT_THAT(poll(7), ElementsAre(kNo, kNo, 'a', kNo, 'b', kNo, kNo));
  live_ = {'c'};
  history_.restore(soc_, 0);
  EXPECT_THAT(poll(7), ElementsAre(kNo, kNo, 'a', kNo, 'b', kNo, kNo))
      << "a replay also repeats the polls after the last byte";
  EXPECT_EQ(reads_, 7);
  EXPECT_THAT(poll(2), ElementsAre('c', kNo));
  history_.restore(soc_, 0);
  EXPECT_THAT(poll(9), ElementsAre(kNo, kNo, 'a', kNo, 'b', kNo, kNo, 'c', kNo));
}

TEST_F(HistoryTest, AReplayFromALaterStateBeginsWithItsInput) {
  live_ = {'a', kNo, 'b', kNo};
  history_.record(soc_);
  poll(2);
  history_.advance();
  history_.record(soc_);
  EXPECT_THAT(poll(2), ElementsAre('b', kNo));
  history_.restore(soc_, 1);
  EXPECT_THAT(poll(2), ElementsAre('b', kNo));
  EXPECT_EQ(reads_, 4);
}

TEST_F(HistoryTest, AReplayRepeatsTheEndOfTheInput) {
  live_ = {kNo, kEnd};
  history_.record(soc_);
  EXPECT_THAT(poll(2), ElementsAre(kNo, kEnd));
  history_.restore(soc_, 0);
  EXPECT_THAT(poll(2), ElementsAre(kNo, kEnd));
  EXPECT_EQ(reads_, 2);
}

/// The host provides each byte only once. Therefore the replayed program must receive the recorded bytes.
TEST_F(HistoryTest, AfterAChangeInThePastTheProgramStillGetsTheBytesThatWereRead) {
  live_ = {'a', kNo, kNo, 'b', 'c'};
  history_.record(soc_);
  poll(5);
  live_ = {'d'};
  history_.restore(soc_, 0);
  EXPECT_THAT(poll(2), ElementsAre('a', kNo));
  history_.cut();
  history_.advance();
  history_.record(soc_);
  EXPECT_THAT(poll(4), ElementsAre(kNo, 'b', 'c', 'd'));
  history_.restore(soc_, 0);
  EXPECT_THAT(poll(4), ElementsAre(kNo, 'b', 'c', 'd'));
}

TEST_F(HistoryTest, ARestartReadsTheLogThenTheHost) {
  live_ = {kNo, 'a', kNo};
  history_.record(soc_);
  poll(3);
  live_ = {'b'};
  history_.restart(soc_);
  EXPECT_THAT(poll(3), ElementsAre(kNo, 'a', 'b'));
}

/// The state of a run that is being stopped is discarded. A byte that this run reads would be lost.
TEST_F(HistoryTest, ReadsNothingWhileTheRunIsBeingStopped) {
  live_ = {'a'};
  history_.record(soc_);
  history_.set_leaves(true);
  EXPECT_THAT(poll(1), ElementsAre(kNo));
  history_.set_leaves(false);
  EXPECT_THAT(poll(1), ElementsAre('a'));
}

TEST_F(HistoryTest, AStopBehindAnInstructionMakesItARepetition) {
  history_.record(soc_);
  history_.advance();
  EXPECT_FALSE(history_.repeats());
  history_.reach(2);
  history_.restore(soc_, 0);
  history_.advance();
  EXPECT_TRUE(history_.repeats());
  history_.advance();
  EXPECT_FALSE(history_.repeats());
}

/// Two states always remain. Any further state exceeds the limit of one byte, so the distance between stored states is
/// doubled.
TEST_F(HistoryTest, KeepsTheFirstAndTheNewestStateWithinALimitOfBytes) {
  History history(1);
  history.record(soc_);
  for (std::uint64_t position = 1; position <= 40; ++position) {
    history.advance();
    history.record(soc_);
    ASSERT_EQ(history.snapshots().size(), 2U) << position;
    EXPECT_EQ(history.snapshots().front().position, 0U);
    EXPECT_EQ(history.snapshots().back().position, std::bit_floor(position));
  }
}

TEST_F(HistoryTest, StaysBelowItsLimitOfBytes) {
  history_.record(soc_);
  const auto one = history_.snapshots().front().state.size();
  History history(6 * one);
  for (int i = 0; i < 100; ++i) {
    history.record(soc_);
    history.advance();
    const auto& states = history.snapshots();
    const auto bytes = std::accumulate(states.begin(), states.end(), std::size_t{0},
                                       [](std::size_t sum, const auto& next) { return sum + next.state.size(); });
    EXPECT_LE(bytes, 6 * one);
    EXPECT_EQ(states.front().position, 0U);
  }
  EXPECT_GE(history.snapshots().size(), 3U) << "no more are dropped than needed";
}

/// A replay identifies its target state by its number, so the numbers must not change during the replay.
TEST_F(HistoryTest, AReplaySavesNoStates) {
  history_.record(soc_);
  for (int i = 0; i < 3; ++i) history_.advance();
  history_.restore(soc_, 0);
  history_.advance();
  history_.record(soc_);
  EXPECT_EQ(history_.snapshots().size(), 1U);
  history_.advance();
  history_.advance();
  history_.record(soc_);
  EXPECT_EQ(history_.snapshots().size(), 2U);
}

}  // namespace
}  // namespace mebots::soc::test
