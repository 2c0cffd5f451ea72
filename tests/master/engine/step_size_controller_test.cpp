// SPDX-License-Identifier: Apache-2.0
#include "engine/step_control/step_size_controller.hpp"

#include "mebots/state/save.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <vector>

namespace mebots::master {
namespace {

constexpr std::int64_t kNoLimit = 1'000'000'000;

StepControlDescription description(std::int64_t most = 1'000'000) {
  StepControlDescription result;
  result.max_steps = most;
  return result;
}

/// Returns the step length after 2000 steps. The error of a step is (length / wanted)^order.
std::int64_t settled(const StepControlDescription& description, double wanted, int order) {
  StepSizeController controller(description);
  std::int64_t steps = 0;
  for (int i = 0; i < 2000; ++i) {
    steps = controller.next(kNoLimit);
    controller.accept({steps, std::pow(static_cast<double>(steps) / wanted, order), order});
  }
  return steps;
}

TEST(StepSizeController, SettlesWhereTheIntegralPartIsOne) {
  // The length is constant if safety * e^-(kI + kP) * e^kP = 1, so that e = safety^(1 / kI). For every order, e is the
  // square of length / wanted.
  const double error = std::pow(0.8, 1 / 0.15);
  for (const int order : {1, 2, 3, 4, 6}) {
    EXPECT_NEAR(static_cast<double>(settled(description(), 100'000, order)), 100'000 * std::sqrt(error), 2) << order;
  }
}

TEST(StepSizeController, SettlesAtTheToleranceWithoutASafetyFactor) {
  auto exact = description();
  exact.safety = 1;
  EXPECT_NEAR(static_cast<double>(settled(exact, 50'000, 2)), 50'000, 2);
}

TEST(StepSizeController, RecoversFromErrorsThatAreNotFinite) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double error : {kInfinity, std::numeric_limits<double>::quiet_NaN()}) {
    auto limited = description(400);
    limited.min_steps = 20;
    limited.initial_steps = 400;
    StepSizeController controller(limited);
    controller.accept({400, error});
    EXPECT_EQ(controller.next(kNoLimit), 80) << "min_factor";
    controller.accept({80, error});
    EXPECT_EQ(controller.next(kNoLimit), 20);
    for (int i = 0; i < 100; ++i) controller.accept({controller.next(kNoLimit), 0});
    EXPECT_EQ(controller.next(kNoLimit), 400);
  }
}

TEST(StepSizeController, StaysWithinItsLimits) {
  auto limited = description(400);
  limited.min_steps = limited.initial_steps = 20;
  StepSizeController controller(limited);
  EXPECT_EQ(controller.next(kNoLimit), 20);
  controller.accept({20, 1e-9});
  EXPECT_EQ(controller.next(kNoLimit), 30) << "max_factor";
  for (int i = 0; i < 20; ++i) controller.accept({controller.next(kNoLimit), 0});
  EXPECT_EQ(controller.next(kNoLimit), 400);
  controller.accept({400, 1e9});
  EXPECT_EQ(controller.next(kNoLimit), 80) << "min_factor";
  controller.accept({80, 1e9});
  EXPECT_EQ(controller.next(kNoLimit), 20);
}

TEST(StepSizeController, GrowsFromTheShortestStep) {
  // Lengths are whole numbers of intervals. 1.5 times the shortest length is not, so the controller must keep the
  // remainder.
  StepSizeController controller(description());
  std::vector<std::int64_t> lengths;
  for (int i = 0; i < 5; ++i) {
    lengths.push_back(controller.next(kNoLimit));
    controller.accept({lengths.back(), 1e-9});
  }
  EXPECT_THAT(lengths, testing::ElementsAre(1, 1, 2, 3, 5));
}

TEST(StepSizeController, DividesTheWayToAPointThatItMustNotPass) {
  auto wide = description();
  wide.initial_steps = 100;
  const StepSizeController controller(wide);
  EXPECT_EQ(controller.next(100), 100);
  EXPECT_EQ(controller.next(101), 51);
  EXPECT_EQ(controller.next(199), 100);
  EXPECT_EQ(controller.next(200), 100);
  EXPECT_EQ(controller.next(7), 7);
}

TEST(StepSizeController, AStepThatWasCutShortDoesNotShortenTheNextOne) {
  auto wide = description();
  wide.initial_steps = 100;
  StepSizeController controller(wide);
  controller.accept({3, 0.01});
  EXPECT_EQ(controller.next(kNoLimit), 100);
  controller.accept({3, 50});
  EXPECT_LT(controller.next(kNoLimit), 3) << "unless its error was too large";
}

TEST(StepSizeController, DoesNotGrowAfterARepeatedStep) {
  auto wide = description();
  wide.initial_steps = 100;
  StepSizeController controller(wide);
  controller.accept({50, 1e-9, 2, true});
  EXPECT_EQ(controller.next(kNoLimit), 50);
}

TEST(StepSizeController, RestartsWithTheInitialStep) {
  auto wide = description();
  wide.initial_steps = 7;
  StepSizeController controller(wide);
  for (int i = 0; i < 10; ++i) controller.accept({controller.next(kNoLimit), 1e-3});
  controller.restart();
  StepSizeController fresh(wide);
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(controller.next(kNoLimit), fresh.next(kNoLimit));
    controller.accept({controller.next(kNoLimit), 0.3});
    fresh.accept({fresh.next(kNoLimit), 0.3});
  }
}

TEST(StepSizeController, ContinuesFromASavedState) {
  const auto limits = description();
  StepSizeController controller(limits);
  for (int i = 0; i < 10; ++i) controller.accept({controller.next(kNoLimit), 0.01 * (i + 1)});
  StepSizeController restored(limits);
  state::restore(restored, state::save(controller));
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(restored.next(kNoLimit), controller.next(kNoLimit));
    for (auto* one : {&restored, &controller}) one->accept({one->next(kNoLimit), 0.1 * i});
  }
}

}  // namespace
}  // namespace mebots::master
