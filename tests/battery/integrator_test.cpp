// SPDX-License-Identifier: Apache-2.0
#include "support.hpp"

#include <array>
#include <cmath>
#include <string>

namespace mebots::battery {
namespace {

Demand load_of(double power_w) {
  return {power_w, power_w, 0, 0};
}

/// Returns a cell whose elements do not depend on the state of charge. Its relaxation has a closed form.
Cell constant_cell() {
  Cell cell = cell_named("bitcraze_250");
  cell.open_circuit_v = Curve::analytic(0, 0, {3.8});
  cell.series_ohm = Curve::analytic(0, 0, {0.1});
  cell.pair1_ohm = Curve::analytic(0, 0, {0.05});
  cell.pair1_farad = Curve::analytic(0, 0, {400});
  cell.pair2_ohm = Curve::analytic(0, 0, {0.06});
  cell.pair2_farad = Curve::analytic(0, 0, {3000});
  return cell;
}

TEST(Integrator, RestingPairsDecayExponentially) {
  const Cell cell = constant_cell();
  Integrator integrator(cell);
  CellState state{0.8, 0.12, 0.15};
  Ledger ledger;
  for (int i = 0; i < 30; ++i) integrator.advance(state, ledger, {}, Protection::closed, 1.0);
  // The integrator's relative tolerance is 1e-9 in each of the 30 calls.
  EXPECT_NEAR(state.pair1_v, 0.12 * std::exp(-30.0 / 20), 1e-9);
  EXPECT_NEAR(state.pair2_v, 0.15 * std::exp(-30.0 / 180), 1e-9);
  // The energy from the capacitors equals the heat in the resistors parallel to them.
  const double stored_before = 0.5 * 400 * 0.12 * 0.12 + 0.5 * 3000 * 0.15 * 0.15;
  const double stored_after = 0.5 * 400 * state.pair1_v * state.pair1_v + 0.5 * 3000 * state.pair2_v * state.pair2_v;
  EXPECT_NEAR(ledger.polarisation_j, stored_after - stored_before, 1e-7);
  EXPECT_NEAR(ledger.ohmic_j, stored_before - stored_after, 1e-7);
}

TEST(Integrator, ConvergesWithTheFourthOrderOfItsMethod) {
  // The fixed steps are long, because rounding errors must be much smaller than truncation errors. The reference is a
  // run with a tight tolerance.
  const Cell cell = cell_named("bitcraze_250");
  const auto run = [&](const Integrator::Options& options) {
    Integrator integrator(cell, options);
    CellState state{0.3, 0, 0};
    Ledger ledger;
    const auto result = integrator.advance(state, ledger, load_of(5), Protection::closed, 64);
    EXPECT_EQ(result.event, Event::none);
    return std::array<double, 3>{state.soc, state.pair1_v, ledger.ohmic_j};
  };
  const auto exact = run({1e-13, 0});
  const auto coarse = run({1e-9, 8});
  const auto fine = run({1e-9, 4});
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const double order = std::log2(std::abs(coarse[i] - exact[i]) / std::abs(fine[i] - exact[i]));
    EXPECT_GT(order, 3.5) << "component " << i;  // 4, reduced by the next term of the error
    EXPECT_LT(order, 4.8) << "component " << i;
  }
}

TEST(Integrator, TwoHalfStepsAgreeWithOneWithinTheTolerance) {
  const Cell cell = cell_named("bitcraze_250");
  Integrator integrator(cell);
  CellState once{0.5, 0.02, 0.01};
  CellState twice = once;
  Ledger ledger_once;
  Ledger ledger_twice;
  integrator.advance(once, ledger_once, load_of(9), Protection::closed, 0.1);
  integrator.advance(twice, ledger_twice, load_of(9), Protection::closed, 0.05);
  integrator.advance(twice, ledger_twice, load_of(9), Protection::closed, 0.05);
  // The relative tolerance of each component is 1e-9. The absolute tolerances are 1e-12 for the state of charge,
  // 1e-10 V and 1e-10 J.
  EXPECT_NEAR(once.soc, twice.soc, 1e-9);
  EXPECT_NEAR(once.pair1_v, twice.pair1_v, 2e-10);
  EXPECT_NEAR(once.pair2_v, twice.pair2_v, 2e-10);
  EXPECT_NEAR(ledger_once.open_circuit_j, ledger_twice.open_circuit_j, 2e-9);
}

TEST(Integrator, ResultDependsOnItsArgumentsAlone) {
  const Cell cell = cell_named("bitcraze_250");
  Integrator used(cell);
  Integrator fresh(cell);
  CellState other{0.9, 0, 0};
  Ledger ignored;
  used.advance(other, ignored, load_of(12), Protection::closed, 3.0);
  used.advance(other, ignored, load_of(0), Protection::open, 0.001);
  CellState a{0.4, 0.05, 0.03};
  CellState b = a;
  Ledger ledger_a;
  Ledger ledger_b;
  used.advance(a, ledger_a, load_of(7), Protection::closed, 0.002);
  fresh.advance(b, ledger_b, load_of(7), Protection::closed, 0.002);
  EXPECT_EQ(a.soc, b.soc);
  EXPECT_EQ(a.pair1_v, b.pair1_v);
  EXPECT_EQ(a.pair2_v, b.pair2_v);
  EXPECT_EQ(ledger_a.ohmic_j, ledger_b.ohmic_j);
}

TEST(Integrator, CutOffIsLocatedWhereTheVoltageCrosses) {
  const Cell cell = cell_named("bitcraze_250");
  Integrator integrator(cell);
  CellState state{0.12, 0.05, 0.05};
  Ledger ledger;
  const auto result = integrator.advance(state, ledger, load_of(9), Protection::closed, 100);
  ASSERT_EQ(result.event, Event::cut_off);
  const Circuit c = cell.circuit_at(state.soc);
  const double source_v = c.open_circuit_v - state.pair1_v - state.pair2_v;
  const double voltage_v = source_v - c.series_ohm * terminal_current_a(source_v, c.series_ohm, 9);
  // The integrator finds the time of the cut-off with an interpolant of order three between two of its steps, so the
  // voltage is less exact than at a step.
  EXPECT_NEAR(voltage_v, cell.cut_off_voltage_v, 1e-6);
  CellState slow{0.12, 0.05, 0.05};
  double passed_s = 0;
  for (;;) {
    const auto part = integrator.advance(slow, ledger, load_of(9), Protection::closed, 0.001);
    passed_s += part.reached_s;
    if (part.event != Event::none) break;
  }
  EXPECT_NEAR(result.reached_s, passed_s, 1e-5);
}

struct LongStep {
  double soc;
  Demand demand;
  double duration_s;
  Event event;
};

void expect_the_same_in_short_steps(const LongStep& step) {
  SCOPED_TRACE(testing::Message() << "charge " << step.soc << ", " << step.demand.terminal_w() << " W, "
                                  << step.duration_s << " s");
  const Cell cell = cell_named("bitcraze_250");
  Integrator integrator(cell);
  CellState once{step.soc, 0, 0};
  Ledger ledger_once;
  const auto whole = integrator.advance(once, ledger_once, step.demand, Protection::closed, step.duration_s);
  ASSERT_EQ(whole.event, step.event);

  CellState state{step.soc, 0, 0};
  Ledger ledger;
  Integrator::Result part;
  double passed_s = 0;
  for (int i = 0; i < 1000 && part.event == Event::none; ++i) {
    part = integrator.advance(state, ledger, step.demand, Protection::closed, step.duration_s / 1000);
    passed_s += part.reached_s;
  }
  EXPECT_EQ(part.event, step.event);
  EXPECT_NEAR(whole.reached_s, passed_s, 1e-5 * passed_s);
  EXPECT_NEAR(once.soc, state.soc, 1e-6);
  EXPECT_NEAR(once.pair1_v, state.pair1_v, 1e-6);
  EXPECT_NEAR(once.pair2_v, state.pair2_v, 1e-6);
  EXPECT_NEAR(ledger_once.open_circuit_j, ledger.open_circuit_j, 1e-6 * std::abs(ledger.open_circuit_j));
  EXPECT_NEAR(ledger_once.imbalance_j(), 0, 1e-9);
}

TEST(Integrator, LongStepsAgreeWithShortOnes) {
  // A single solver step for the whole duration would evaluate the cell where a resistance is negative or the voltage
  // is not a number.
  expect_the_same_in_short_steps({0.9, load_of(0.01), 86'400, Event::none});
  expect_the_same_in_short_steps({0.5, load_of(5), 3000, Event::cut_off});
  expect_the_same_in_short_steps({0.03, load_of(5), 600, Event::cut_off});
  expect_the_same_in_short_steps({0.3, load_of(20), 600, Event::cut_off});
  expect_the_same_in_short_steps({0.5, {0, 0, 1, 1}, 3600, Event::full});
}

TEST(Integrator, TinyCellIsEmptiedWhereItsChargeEnds) {
  Cell cell = constant_cell();
  cell.capacity_c = 1e-9;
  Integrator integrator(cell);
  CellState state{0.5, 0, 0};
  Ledger ledger;
  const auto result = integrator.advance(state, ledger, load_of(1), Protection::closed, 60);
  EXPECT_EQ(result.event, Event::empty);
  EXPECT_EQ(state.soc, 0);
  const double current_a = terminal_current_a(3.8, 0.1, 1);
  EXPECT_NEAR(result.reached_s, 0.5e-9 / (current_a + cell.self_discharge_current_a), 1e-6 * result.reached_s);
}

/// Returns the error message of a step of 60 s, and checks that the step changed nothing.
std::string refusal(const Cell& cell, const Demand& demand) {
  Integrator integrator(cell);
  CellState state{0.5, 0.01, 0.02};
  Ledger ledger;
  ledger.delivered_j = 7;
  const auto message = error_of([&] { integrator.advance(state, ledger, demand, Protection::closed, 60); });
  EXPECT_EQ(state.soc, 0.5);
  EXPECT_EQ(state.pair1_v, 0.01);
  EXPECT_EQ(ledger.delivered_j, 7);
  return message;
}

TEST(Integrator, StepThatCannotBeIntegratedIsReportedAndChangesNothing) {
  using testing::AllOf;
  using testing::HasSubstr;
  EXPECT_THAT(refusal(constant_cell(), {0, 0, 1e308, 1e308}),
              AllOf(HasSubstr("over a step of 60 s at -1e+308 W"), HasSubstr("Use shorter steps, less power")));

  Cell stiff = constant_cell();
  stiff.pair1_farad = Curve::analytic(0, 0, {4e-9});  // 0.2 ns
  EXPECT_THAT(refusal(stiff, load_of(1)),
              AllOf(HasSubstr("over a step of 60 s at 1 W"), HasSubstr("longer time constants")));
  // A step that is short compared with the time constant succeeds.
  Integrator integrator(stiff);
  CellState state{0.5, 0.01, 0.02};
  Ledger ledger;
  EXPECT_EQ(integrator.advance(state, ledger, load_of(1), Protection::closed, 1e-6).event, Event::none);
  EXPECT_NEAR(state.pair1_v, 0.05 * terminal_current_a(3.8 - state.pair1_v - 0.02, 0.1, 1), 1e-6);
}

}  // namespace
}  // namespace mebots::battery
