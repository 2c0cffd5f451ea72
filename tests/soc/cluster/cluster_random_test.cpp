// SPDX-License-Identifier: Apache-2.0
// Runs random programs of fabric controller and cluster in four ways. All must give the same bits.
#include "board_system.hpp"
#include "hart/observer.hpp"
#include "random_cluster_program.hpp"
#include "support/same_state.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <map>
#include <memory>
#include <random>
#include <span>

namespace mebots::soc::test {
namespace {

class Onlooker final : public Observer {
 public:
  void retired(const Hart& /*hart*/, const Retired& /*instruction*/) override { ++count_; }

 private:
  std::uint64_t count_ = 0;
};

/// An observer that receives only the steps of its FlowMap, so that hot code stays translated. Checks that no
/// counter decreases from step to step.
class StepCounter final : public Observer, private FlowMap {
 public:
  const FlowMap* flow() const override { return this; }
  void flowed(const Hart& hart, std::span<const Flow> steps) override {
    auto& last = last_[&hart];
    for (const auto& step : steps) {
      EXPECT_GT(step.cycles, last.cycles);
      EXPECT_GT(step.instructions, last.instructions);
      EXPECT_GE(step.instruction_fj, last.instruction_fj + step.instructions - last.instructions);
      EXPECT_GE(step.accesses, last.accesses);
      EXPECT_GE(step.far_accesses, last.far_accesses);
      EXPECT_GE(step.fetch_cycles, last.fetch_cycles);
      last = step;
    }
    EXPECT_EQ(last.cycles, hart.counters().cycles);
    EXPECT_EQ(last.instructions, hart.counters().instructions);
  }

 private:
  bool may_leave_function(std::uint32_t pc, std::uint32_t next) const override { return (pc ^ next) / 2 % 3 == 0; }
  std::map<const Hart*, Flow> last_;
};

/// Runs a program in four ways. The first run is translated and has no interruption. The second is interpreted, and the
/// third is sometimes observed. The fourth is sometimes restored from a state of the first run, into a new system or
/// into a system that has run another program.
class Comparison {
 public:
  explicit Comparison(std::uint32_t seed)
      : random_(seed), program_(BoardSystem::assembled(random_cluster_program(seed))) {
    settings_.cluster_cores = below(3) == 0 ? 1 + below(8) : 8;
    for (auto& memory : board_.memories) {
      if (memory.place != Place::cluster) {
        if (seed % 3 == 1) memory.latency = {.fabric_controller = 3, .cluster = 2, .soc = 17};  // shared by the cores
        continue;
      }
      memory.arbitration_tree = seed % 2 == 0;
      constexpr std::array kQuanta{64U, 1U, 17U, 256U, 1024U};
      memory.quantum = kQuanta[seed % kQuanta.size()];
    }
    straight_ = made();
    restored_ = made();
    watched_ = made();
    settings_.translate = false;
    interpreted_ = made();
    settings_.translate = true;
  }

  /// Advances all runs to about `end_ns` in `stops` pieces, and compares them after each piece. Returns early if the
  /// program ends with a repeated trap.
  void run(std::int64_t end_ns, unsigned stops) {
    watch(true);
    for (unsigned stop = 0; stop < stops && straight_->soc.running(); ++stop) {
      const auto longest = below(4) == 0 ? 1000 : 2 * end_ns / stops;
      now_ += 1 + static_cast<std::int64_t>(random_() % static_cast<std::uint64_t>(longest));
      continue_run(*straight_);
      expect_same("interpreted", *interpreted_);
      expect_same("watched", *watched_);
      expect_same("restored", *restored_);
      if (testing::Test::HasFailure()) return;
      if (below(3) == 0) {
        if (below(2) == 0) restored_ = made();
        state::restore(restored_->soc, state::save(straight_->soc));
        restored_at_ = now_;
      }
      if (below(4) == 0) watch(!watching_);
    }
  }

  std::uint64_t instructions() const { return straight_->soc.instructions(); }

 private:
  unsigned below(unsigned count) { return static_cast<unsigned>(random_() % count); }
  std::unique_ptr<BoardSystem> made() { return std::make_unique<BoardSystem>(program_, settings_, board_); }

  void watch(bool on) {
    watching_ = on;
    Observer* observer = &onlooker_;
    if (below(2) == 0) observer = &step_counter_;
    for (unsigned number = 0; number < watched_->soc.harts(); ++number) {
      watched_->soc.observe(number, on ? observer : nullptr);
    }
  }

  /// Advances a system to the time `now_`, sometimes in several steps.
  void continue_run(BoardSystem& system) {
    auto time = system.soc.now() / 1000;
    for (auto cuts = below(3) == 0 ? below(20) : 0; cuts-- > 0;) {
      time += 1 + below(below(2) == 0 ? 100 : 5000);
      if (time >= now_) break;
      system.soc.advance(time);
    }
    system.soc.advance(now_);
  }

  void expect_same(std::string_view who, BoardSystem& system) {
    continue_run(system);
    EXPECT_TRUE(mebots::test::same_state(straight_->soc, system.soc))
        << who << ", at " << now_ << " ns, restored at " << restored_at_ << " ns";
    EXPECT_EQ(straight_->soc.energy().total_j(), system.soc.energy().total_j()) << who << ", at " << now_ << " ns";
  }

  std::mt19937_64 random_;
  Elf program_;
  Settings settings_;
  BoardDescription board_ = BoardSystem::ai_deck();
  Onlooker onlooker_;
  StepCounter step_counter_;
  std::unique_ptr<BoardSystem> straight_;
  std::unique_ptr<BoardSystem> interpreted_;
  std::unique_ptr<BoardSystem> watched_;
  std::unique_ptr<BoardSystem> restored_;
  std::int64_t now_ = 0;
  std::int64_t restored_at_ = 0;
  bool watching_ = false;
};

unsigned number_from(const char* variable, unsigned otherwise) {
  const char* text = std::getenv(variable);
  return text != nullptr ? static_cast<unsigned>(std::stoul(text)) : otherwise;
}

/// scripts/random_cluster.sh runs this test with other programs.
TEST(ClusterRandom, ProgramsHaveTheSameBitsInAllRuns) {
  const auto first = number_from("MEBOTS_CLUSTER_FIRST", 1);
  const auto end = first + number_from("MEBOTS_CLUSTER_PROGRAMS", 24);
  std::uint64_t instructions = 0;
  for (auto seed = first; seed < end && !HasFailure(); ++seed) {
    const testing::ScopedTrace trace(__FILE__, __LINE__, fmt::format("program {}", seed));
    Comparison comparison(seed);
    comparison.run(2 * kMs, 30);
    instructions += comparison.instructions();
  }
  EXPECT_GT(instructions, 10'000U * (end - first));
  RecordProperty("instructions", std::to_string(instructions));
}

}  // namespace
}  // namespace mebots::soc::test
