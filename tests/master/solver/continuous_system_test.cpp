// SPDX-License-Identifier: Apache-2.0
#include "solver/continuous_system.hpp"

#include "mebots/state/save.hpp"
#include "solver/plain_models.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <numbers>

namespace mebots::master {
namespace {

using Laws = PlainModel::Laws;
using Values = PlainModel::Values;

/// Returns the model x' = -rate (x - input). Variable 0 is the output x, and variable 1 is the input.
Laws decay(double rate) {
  return {.states = 1, .values = 2, .derivatives = [rate](double, const Values& v, auto d) {
            d[0] = -rate * (v[0] - v[1]);
          }};
}

/// Returns a ball that falls and bounces with a coefficient of restitution.
Laws bouncing_ball(double restitution, double rest_below) {
  return {.states = 2,
          .values = 2,
          .indicators = 1,
          .derivatives =
              [](double, const Values& v, auto d) {
                d[0] = v[1];
                d[1] = v[1] == 0 && v[0] <= 0 ? 0 : -9.81;
              },
          .indicators_of = [](double, const Values& v, auto z) { z[0] = v[1] == 0 && v[0] <= 0 ? 1 : v[0]; },
          .update =
              [=](double, Values& v) {
                if (v[0] <= 0 && v[1] < 0) {
                  v[0] = std::numeric_limits<double>::min();
                  v[1] = -restitution * v[1];
                  if (v[1] < rest_below) v = {0, 0};
                }
                return DiscreteUpdate{};
              }};
}

ContinuousSystem::Parts parts_of(std::vector<ContinuousInstance*> members, std::vector<Wire> wires = {},
                                 double tolerance = 1e-8) {
  ContinuousSystem::Parts parts;
  parts.members = std::move(members);
  parts.wires = std::move(wires);
  parts.relative_tolerance = tolerance;
  return parts;
}

void run(ContinuousSystem& system, double until_s, int points) {
  for (int k = 1; k <= points; ++k) system.advance(until_s * k / points);
}

std::string error_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(ContinuousSystem, IntegratesADecayToItsTolerance) {
  PlainModel model("a", decay(2), {1, 0});
  ContinuousSystem system(parts_of({&model}), {});
  system.initialize(0);
  run(system, 3, 30);
  EXPECT_NEAR(model.value(0), std::exp(-6.0), 1e-8);
  EXPECT_EQ(model.time(), 3);
}

TEST(ContinuousSystem, KeepsOrderAndStepOverCommunicationPoints) {
  PlainModel few("a", decay(1), {1, 0});
  PlainModel many("a", decay(1), {1, 0});
  ContinuousSystem one(parts_of({&few}), {.max_step_s = 10.0});
  ContinuousSystem thousand(parts_of({&many}), {.max_step_s = 10.0});
  for (auto* system : {&one, &thousand}) system->initialize(0);
  run(one, 5, 10);
  run(thousand, 5, 1000);
  EXPECT_LT(thousand.statistics().counts.steps, one.statistics().counts.steps + 20);
  EXPECT_EQ(thousand.statistics().counts.restarts, 1);
  EXPECT_NEAR(many.value(0), std::exp(-5.0), 1e-8);
}

TEST(ContinuousSystem, EvaluatesConnectionsInsideTheRightHandSide) {
  // Two coupled decays x' = -(x - y) and y' = -(y - x): the sum is constant, and the difference decays with rate 2.
  PlainModel a("a", decay(1), {1, 0});
  PlainModel b("b", decay(1), {0, 0});
  const std::vector<Wire> wires = {{.from = {0, 0}, .to = {1, 1}, .dependencies = std::vector<ValueReference>{}},
                                   {.from = {1, 0}, .to = {0, 1}, .dependencies = std::vector<ValueReference>{}}};
  ContinuousSystem system(parts_of({&a, &b}, wires), {});
  system.initialize(0);
  run(system, 1, 1);
  EXPECT_NEAR(a.value(0) + b.value(0), 1, 1e-12);
  EXPECT_NEAR(a.value(0) - b.value(0), std::exp(-2.0), 1e-7);
}

TEST(ContinuousSystem, ReadsOutputsAfterTheInputsThatTheyDependOn) {
  // A chain of gains y = 3 u without declared dependencies. The last instance of the chain comes first in the system,
  // so the outputs cannot be read in this order.
  const Laws gain = {.values = 2, .outputs = [](double, Values& v) { v[1] = 3 * v[0]; }};
  PlainModel last("c", gain, {0, 0});
  PlainModel middle("b", gain, {0, 0});
  PlainModel first("a", decay(1), {1, 0});
  const std::vector<Wire> wires = {{.from = {1, 1}, .to = {0, 0}},
                                   {.from = {2, 0}, .to = {1, 0}, .dependencies = std::vector<ValueReference>{}}};
  ContinuousSystem system(parts_of({&last, &middle, &first}, wires), {});
  system.initialize(0);
  run(system, 1, 4);
  EXPECT_NEAR(last.value(1), 9 * std::exp(-1.0), 1e-6);
}

TEST(ContinuousSystem, SettlesALoopThatContracts) {
  // y = 0.5 u + 1 and u = y have the solution 2.
  const Laws half = {.values = 2, .outputs = [](double, Values& v) { v[1] = 0.5 * v[0] + 1; }};
  PlainModel a("a", half, {0, 0});
  PlainModel b("b", {.values = 2, .outputs = [](double, Values& v) { v[1] = v[0]; }}, {0, 0});
  ContinuousSystem system(parts_of({&a, &b}, {{.from = {0, 1}, .to = {1, 0}}, {.from = {1, 1}, .to = {0, 0}}}), {});
  system.initialize(0);
  run(system, 1, 1);
  EXPECT_NEAR(a.value(1), 2, 1e-14);
}

TEST(ContinuousSystem, NamesALoopThatDoesNotSettle) {
  const Laws twice = {.values = 2, .outputs = [](double, Values& v) { v[1] = 2 * v[0] + 1; }};
  PlainModel a("a", twice, {0, 0});
  PlainModel b("b", twice, {0, 0});
  ContinuousSystem system(parts_of({&a, &b}, {{.from = {0, 1}, .to = {1, 0}, .from_name = "a.y", .to_name = "b.u"},
                                              {.from = {1, 1}, .to = {0, 0}, .from_name = "b.y", .to_name = "a.u"}}),
                          {});
  EXPECT_THAT(error_of([&] { system.initialize(0); }), testing::HasSubstr("a.y -> b.u -> b.y -> a.u -> a.y"));
}

TEST(ContinuousSystem, FindsTheTimesOfImpactsExactly) {
  PlainModel ball("ball", bouncing_ball(0.7, 0.1), {1, 0});
  ContinuousSystem system(parts_of({&ball}, {}, 1e-10), {});
  system.initialize(0);
  // The ball falls for sqrt(2 h / g). After impact n, it flies for 2 e^n v / g.
  const double first_s = std::sqrt(2 / 9.81);
  const double speed = 9.81 * first_s;
  system.advance(first_s + 0.7 * speed / 9.81);  // at the top of the first flight
  EXPECT_NEAR(ball.value(0), 0.49, 1e-9);
  EXPECT_NEAR(ball.value(1), 0, 1e-8);
  EXPECT_EQ(system.statistics().counts.state_events, 1);
  system.advance(first_s + 2 * 0.7 * speed / 9.81 + 0.49 * speed / 9.81);
  EXPECT_NEAR(ball.value(0), 0.49 * 0.49, 1e-8);
  system.advance(4);
  EXPECT_EQ(ball.value(0), 0);  // at rest
  EXPECT_EQ(ball.value(1), 0);
}

TEST(ContinuousSystem, NamesTheModelOfEventsWithoutEnd) {
  PlainModel other("other", decay(1), {1, 0});
  PlainModel ball("ball", bouncing_ball(0.7, 0), {1, 0});
  ContinuousSystem system(parts_of({&other, &ball}, {}, 1e-10), {});
  system.initialize(0);
  const auto text = error_of([&] { system.advance(5); });
  EXPECT_THAT(text, testing::AllOf(testing::HasSubstr("20 events follow each other"), testing::HasSubstr("of 'ball'")));
}

TEST(ContinuousSystem, SolvesRobertsonsStiffKinetics) {
  // Solution at t = 40: Hairer and Wanner, Solving Ordinary Differential Equations II.
  const Laws robertson = {.states = 3, .values = 3, .derivatives = [](double, const Values& v, auto d) {
                            d[0] = -0.04 * v[0] + 1e4 * v[1] * v[2];
                            d[2] = 3e7 * v[1] * v[1];
                            d[1] = -d[0] - d[2];
                          }};
  PlainModel model("r", robertson, {1, 0, 0});
  ContinuousSystem system(parts_of({&model}, {}, 1e-8), {.absolute_tolerance = 1e-14});
  system.initialize(0);
  run(system, 40, 4);
  EXPECT_NEAR(model.value(0), 0.7158270687, 1e-7);
  EXPECT_NEAR(model.value(1), 0.9185534764e-5, 1e-11);
  EXPECT_NEAR(model.value(2), 0.2841637457, 1e-7);
  EXPECT_LT(system.statistics().counts.steps, 1000);
}

TEST(ContinuousSystem, HandlesTimeEventsAtTheirTimes) {
  // The model adds 1 to its state every 0.3 s.
  const Laws clock = {.states = 1,
                      .values = 2,
                      .derivatives = [](double, const Values&, auto d) { d[0] = 0; },
                      .update =
                          [](double t, Values& v) {
                            if (t >= v[1] - 1e-9) {
                              if (v[1] > 0) v[0] += 1;
                              v[1] += 0.3;
                            }
                            return DiscreteUpdate{.next_event_s = v[1]};
                          }};
  PlainModel model("clock", clock, {0, 0});
  ContinuousSystem system(parts_of({&model}), {});
  system.initialize(0);
  system.advance(0.29);
  EXPECT_EQ(model.value(0), 0);
  system.advance(0.31);
  EXPECT_EQ(model.value(0), 1);
  system.advance(1);
  EXPECT_EQ(model.value(0), 3);
  EXPECT_EQ(system.statistics().counts.time_events, 3);
}

TEST(ContinuousSystem, HandlesEventsThatACompletedStepRequests) {
  auto laws = decay(1);
  laws.completed = [](double t, Values& v) { return CompletedStep{.enter_event_mode = t > 0.5 && v[1] == 0}; };
  laws.update = [](double t, Values& v) {
    if (t > 0.5) v[1] = 1;
    return DiscreteUpdate{};
  };
  PlainModel model("a", laws, {1, 0});
  ContinuousSystem system(parts_of({&model}), {});
  system.initialize(0);
  system.advance(1);
  EXPECT_EQ(system.statistics().counts.step_events, 1);
  EXPECT_EQ(system.statistics().counts.restarts, 2) << "the event changes the derivative";
  EXPECT_EQ(model.value(1), 1);
}

TEST(ContinuousSystem, KeepsTheSolversStepsIfAStepEventChangesNothing) {
  auto laws = decay(1);
  laws.completed = [](double, Values&) { return CompletedStep{.enter_event_mode = true}; };
  PlainModel eventful("a", laws, {1, 0});
  PlainModel plain("a", decay(1), {1, 0});
  ContinuousSystem with_events(parts_of({&eventful}), {});
  ContinuousSystem without(parts_of({&plain}), {});
  for (auto* system : {&with_events, &without}) {
    system->initialize(0);
    system->advance(1);
  }
  EXPECT_EQ(eventful.value(0), plain.value(0));
  EXPECT_GT(with_events.statistics().counts.step_events, 10);
  EXPECT_EQ(with_events.statistics().counts.restarts, 1);
}

TEST(ContinuousSystem, RestartsIfAStepEventChangesTheSignOfAnIndicator) {
  // A clock x' = 1 with the threshold v[1]. One step event moves the threshold from above x to below x.
  const Laws laws = {
      .states = 1,
      .values = 2,
      .indicators = 1,
      .derivatives = [](double, const Values&, auto d) { d[0] = 1; },
      .indicators_of = [](double, const Values& v, auto z) { z[0] = v[0] - v[1]; },
      .update =
          [](double t, Values& v) {
            if (t > 0.5) v[1] = 0.25;
            return DiscreteUpdate{};
          },
      .completed = [](double t, Values& v) { return CompletedStep{.enter_event_mode = t > 0.5 && v[1] == 2}; }};
  PlainModel model("clock", laws, {0, 2});
  ContinuousSystem system(parts_of({&model}), {});
  system.initialize(0);
  run(system, 1, 10);
  EXPECT_EQ(system.statistics().counts.step_events, 1);
  EXPECT_EQ(system.statistics().counts.restarts, 2) << "the solver must not compare with the sign before the event";
  EXPECT_EQ(system.statistics().counts.state_events, 0) << "the step event itself moves the threshold";
}

TEST(ContinuousSystem, PassesEventsOnToOtherMembers) {
  // `a` jumps at 0.5. `b` counts the increases of its input in event mode.
  const Laws jump = {.values = 1, .update = [](double t, Values& v) {
                       if (t >= 0.5) v[0] = 1;
                       return DiscreteUpdate{.next_event_s = t < 0.5 ? std::optional(0.5) : std::nullopt};
                     }};
  const Laws counter = {.values = 3, .update = [](double, Values& v) {
                          if (v[0] > v[2]) v[1] += 1;
                          v[2] = v[0];
                          return DiscreteUpdate{};
                        }};
  PlainModel b("b", counter, {0, 0, 0});
  PlainModel a("a", jump, {0});
  ContinuousSystem system(parts_of({&b, &a}, {{.from = {1, 0}, .to = {0, 0}}}), {});
  system.initialize(0);
  system.advance(1);
  EXPECT_EQ(b.value(1), 1);
}

TEST(ContinuousSystem, NamesMembersWhoseEventDoesNotSettle) {
  PlainModel calm("calm", decay(1), {1, 0});
  auto laws = decay(1);
  laws.update = [](double, Values&) { return DiscreteUpdate{.needs_another = true}; };
  PlainModel restless("restless", laws, {1, 0});
  ContinuousSystem system(parts_of({&calm, &restless}), {});
  EXPECT_THAT(error_of([&] { system.initialize(0); }),
              testing::AllOf(testing::HasSubstr("does not end"), testing::HasSubstr("another update: 'restless'")));
}

TEST(ContinuousSystem, NamesTheStateWhoseDerivativeIsNoNumber) {
  PlainModel model("a",
                   {.states = 2,
                    .values = 2,
                    .derivatives =
                        [](double t, const Values&, auto d) {
                          d[0] = 0;
                          d[1] = std::sqrt(1 - t);
                        }},
                   {0, 0});
  ContinuousSystem system(parts_of({&model}), {});
  system.initialize(0);
  const auto text = error_of([&] { run(system, 2, 20); });
  EXPECT_THAT(text, testing::ContainsRegex("instance 'a' at 1.*: the derivative of the state 'x1' is -?nan"));
}

TEST(ContinuousSystem, StopsAtTheLimitOfSteps) {
  PlainModel model(
      "a",
      {.states = 1, .values = 1, .derivatives = [](double t, const Values&, auto d) { d[0] = std::sin(1000 * t); }},
      {0});
  ContinuousSystem system(parts_of({&model}), {.max_steps = 100});
  system.initialize(0);
  EXPECT_THAT(error_of([&] { system.advance(10); }), testing::HasSubstr("100 steps in one communication step of 10 s"));
}

TEST(ContinuousSystem, EndsWhereAMemberRequestsIt) {
  auto laws = decay(1);
  laws.indicators = 1;
  laws.indicators_of = [](double t, const Values&, auto z) { z[0] = 0.5 - t; };
  laws.update = [](double t, Values&) { return DiscreteUpdate{.terminate = t >= 0.5}; };
  PlainModel model("a", laws, {1, 0});
  ContinuousSystem system(parts_of({&model}), {});
  system.initialize(0);
  const auto reached = system.advance(1);
  EXPECT_EQ(reached.terminated_by, "a");
  EXPECT_NEAR(reached.time_s, 0.5, 1e-12);
}

/// An oscillator that provides directional derivatives.
class LinearModel final : public PlainModel {
 public:
  LinearModel(std::string name, Values start)
      : PlainModel(std::move(name),
                   {.states = 2,
                    .values = 4,
                    .derivatives =
                        [](double, const Values& v, auto d) {
                          d[0] = v[1];
                          d[1] = -1e4 * v[0] + v[2];
                        },
                    .outputs = [](double, Values& v) { v[3] = 0.1 * v[0] + 0.01 * v[2]; }},
                   std::move(start)) {}

  bool has_directional_derivatives() const override { return true; }
  std::span<const ValueReference> state_references() const override { return states_; }
  std::span<const ValueReference> derivative_references() const override { return derivatives_; }
  void directional_derivatives(std::span<const ValueReference> unknowns, std::span<const ValueReference> knowns,
                               std::span<const double> seed, std::span<double> change) override {
    ++products;
    Values dv(4, 0.0);
    for (std::size_t i = 0; i < knowns.size(); ++i) dv[knowns[i]] = seed[i];
    for (std::size_t i = 0; i < unknowns.size(); ++i) {
      change[i] = unknowns[i] == 10 ? dv[1] : unknowns[i] == 11 ? -1e4 * dv[0] + dv[2] : 0.1 * dv[0] + 0.01 * dv[2];
    }
  }
  int products = 0;

 private:
  std::array<ValueReference, 2> states_ = {0, 1};
  std::array<ValueReference, 2> derivatives_ = {10, 11};
};

TEST(ContinuousSystem, TakesTheJacobianFromDirectionalDerivatives) {
  LinearModel a("a", {1, 0});
  LinearModel b("b", {0, 0});
  const std::vector<Wire> wires = {
      {.from = {0, 3}, .to = {1, 2}, .factor = 2, .dependencies = std::vector<ValueReference>{}}};
  ContinuousSystem with(parts_of({&a, &b}, wires), {});
  with.initialize(0);
  run(with, 0.1, 2);
  EXPECT_GT(a.products, 0);
  EXPECT_NEAR(a.value(0), std::cos(10.0), 1e-5);
  EXPECT_GT(with.statistics().counts.jacobians, 0);
}

TEST(ContinuousSystem, ContinuesWithTheSameBitsAfterARestore) {
  const auto straight = [](std::optional<int> interrupted_after) {
    auto ball = std::make_unique<PlainModel>("ball", bouncing_ball(0.8, 0.1), Values{1, 0});
    PlainModel other("other", decay(3), {1, 0});
    auto system = std::make_unique<ContinuousSystem>(parts_of({ball.get(), &other}), SolverDescription{});
    system->initialize(0);
    for (int k = 1; k <= 200; ++k) {
      system->advance(k * 0.01);
      if (k != interrupted_after) continue;
      const auto bytes = state::save(*system);
      auto resumed = std::make_unique<ContinuousSystem>(parts_of({ball.get(), &other}), SolverDescription{});
      state::restore(*resumed, bytes);
      EXPECT_TRUE(resumed->must_repeat());
      EXPECT_TRUE(resumed->repeat_steps([&] {
        const Values kept = {ball->value(0), ball->value(1), other.value(0), ball->time()};
        return [&, kept] {
          ball->set_time(kept[3]);
          other.set_time(kept[3]);
          ball->set_states(std::span(kept).first(2));
          other.set_states(std::span(kept).subspan(2, 1));
        };
      }));
      system = std::move(resumed);
    }
    return std::vector<double>{ball->value(0), ball->value(1), other.value(0),
                               static_cast<double>(system->statistics().counts.steps)};
  };
  const auto whole = straight({});
  for (const int k : {1, 10, 37, 44, 45, 46, 111, 199}) EXPECT_EQ(straight(k), whole) << k;
}

TEST(ContinuousSystem, NoticesThatStepsCannotBeRepeated) {
  int calls = 0;
  PlainModel model("a",
                   {.states = 1,
                    .values = 1,
                    .derivatives = [&](double, const Values& v, auto d) { d[0] = -v[0] + 1e-9 * ++calls; }},
                   {1});
  ContinuousSystem system(parts_of({&model}), {});
  system.initialize(0);
  run(system, 0.5, 5);
  const auto bytes = state::save(system);
  state::restore(system, bytes);
  EXPECT_FALSE(system.repeat_steps([] { return [] {}; }));
  system.advance(0.6);
  EXPECT_EQ(system.statistics().counts.restarts, 2);
}

TEST(ContinuousSystem, NeverEvaluatesAfterTheLatestTime) {
  double latest = 0;
  PlainModel model("a",
                   {.states = 1,
                    .values = 1,
                    .derivatives =
                        [&](double t, const Values& v, auto d) {
                          latest = std::max(latest, t);
                          d[0] = -v[0];
                        }},
                   {1});
  auto parts = parts_of({&model});
  parts.latest_s = 1.0;
  ContinuousSystem system(parts, {});
  system.initialize(0);
  run(system, 1, 7);
  EXPECT_LE(latest, 1.0);
  EXPECT_NEAR(model.value(0), std::exp(-1.0), 1e-7);
}

TEST(ContinuousSystem, StartsAnewWhenAnInputChanges) {
  PlainModel model("a", decay(1), {0, 0});
  ContinuousSystem system(parts_of({&model}), {});
  system.initialize(0);
  system.advance(1);
  const ValueReference input = 1;
  const double one = 1;
  model.set_inputs({&input, 1}, {&one, 1});
  system.input_changed();
  system.advance(2);
  EXPECT_NEAR(model.value(0), 1 - std::exp(-1.0), 1e-7);
  EXPECT_EQ(system.statistics().counts.restarts, 2);
}

}  // namespace
}  // namespace mebots::master
