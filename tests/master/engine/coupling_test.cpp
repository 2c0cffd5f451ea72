// SPDX-License-Identifier: Apache-2.0
// Tests the transfer of values between instances, and steps that are pending, discarded or end early.
#include "fmi/fmu.hpp"
#include "slave/fmi/fmi2_slave.hpp"
#include "test_system.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace mebots::master {
namespace {

using test::TestRun;
using testing::AllOf;
using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

/// Returns a config with two instances, a and b, of tests/fmus/coupling.c.
std::string pair(const std::string& parameters, const std::string& connections, const std::string& more = "",
                 const std::string& times = R"("step": 0.1, "stop_time": 0.2)") {
  return fmt::format(
      R"({{{}, "instances": {{"a": {{"fmu": "COUPLING", "parameters": {{{}}}}}, "b": {{"fmu": "COUPLING"}}}}, "connections": [{}]{}}})",
      times, parameters, connections, more);
}

std::string refused(const std::string& connection) {
  return test::input_error([&] { TestRun(pair("", connection)); });
}

double at_start(const std::string& config, const std::string& column) {
  return TestRun(config).initialize().column(column).front();
}

TEST(Units, CelsiusBecomesKelvin) {
  EXPECT_DOUBLE_EQ(
      at_start(pair(R"("celsius": 21.5)", R"({"from": "a.celsius", "to": "b.kelvin_in"})"), "b.kelvin_out"), 294.65);
}

TEST(Units, KilometresPerHourBecomeMetresPerSecond) {
  EXPECT_DOUBLE_EQ(
      at_start(pair(R"("speed_kmh": 36)", R"({"from": "a.speed_kmh", "to": "b.speed_in"})"), "b.speed_out"), 10);
}

TEST(Units, DegreesBecomeRadians) {
  EXPECT_DOUBLE_EQ(
      at_start(pair(R"("angle_deg": 180)", R"({"from": "a.angle_deg", "to": "b.angle_in"})"), "b.angle_out"),
      std::numbers::pi);
}

TEST(Units, MilliampereHoursBecomeCoulombs) {
  EXPECT_DOUBLE_EQ(
      at_start(pair(R"("charge_mah": 250)", R"({"from": "a.charge_mah", "to": "b.charge_in"})"), "b.charge_out"), 900);
}

TEST(Sums, AnInputGetsTheSumOfItsConnectionsAtEachPoint) {
  // 3.6 km/h is 1 m/s. `now` is the time t. b receives 1 + 2 t + 10 at the start of each step, and outputs it at the
  // end.
  const auto column = [](const std::string& type, const std::string& order) {
    const std::string parts[] = {R"({"from": "a.speed_kmh", "to": "b.speed_in", "sum": true})",
                                 R"({"from": "a.now", "to": "b.speed_in", "sum": true, "factor": 2})",
                                 R"({"from": "a.count", "to": "b.speed_in", "sum": true})"};
    std::string connections;
    for (const char part : order) connections += (connections.empty() ? "" : ", ") + parts[part - '0'];
    return TestRun(pair(R"("speed_kmh": 3.6, "count": 10)", connections, R"(, "algorithm": ")" + type + "\"",
                        R"("step": 0.25, "stop_time": 1)"))
        .to_end()
        .column("b.speed_out");
  };
  constexpr double kRounding = 1e-14;
  const auto are = [&](const std::vector<double>& values) {
    return testing::Pointwise(testing::DoubleNear(kRounding), values);
  };
  EXPECT_THAT(column("jacobi", "012"), are({11, 11, 11.5, 12, 12.5}));
  EXPECT_EQ(column("jacobi", "012"), column("jacobi", "210"));
  EXPECT_THAT(column("gauss-seidel", "102"), are({11, 11.5, 12, 12.5, 13}));
}

TEST(Sums, EachConnectionSaysThatItIsAPart) {
  const auto of = [](const std::string& more) {
    return test::input_error([&] {
      TestRun(pair("", R"({"from": "a.now", "to": "b.bare_in", "sum": true}, {"from": "a.furlong", "to": "b.bare_in")" +
                           more + "}"));
    });
  };
  EXPECT_THAT(of(""), AllOf(HasSubstr("/connections/1"), HasSubstr("two sources: a.now"), HasSubstr("\"sum\": true")));
  EXPECT_THAT(of(R"(, "sum": true)"), HasSubstr("no InputError"));
  EXPECT_THAT(refused(R"({"from": "a.count", "to": "b.count_in", "sum": true})"), HasSubstr("type Real"));
}

TEST(Maps, ValuesThatAreNamedBecomeOthers) {
  const auto mapped = [](const std::string& count, const std::string& map) {
    return TestRun(pair(R"("count": )" + count, R"({"from": "a.count", "to": "b.level_in", "map": )" + map + "}"))
        .to_end()
        .column("a.count")
        .size();
  };
  EXPECT_EQ(mapped("7", R"({"7": "high", "-3": "low"})"), 3U);
  EXPECT_EQ(mapped("5", R"({"7": "low"})"), 3U);        // 5 is an item of the target
  EXPECT_THROW(mapped("6", R"({"7": "low"})"), Error);  // 6 is not an item of the target
  EXPECT_THAT(refused(R"({"from": "a.count", "to": "b.level_in", "map": {"7": "middle"}})"),
              AllOf(HasSubstr("/connections/0/map/7"), HasSubstr("'middle' is not an item")));
  EXPECT_THAT(refused(R"({"from": "a.count", "to": "b.level_in", "map": {"07": 5, "7": 5}})"),
              HasSubstr("two values for 7"));
  EXPECT_THAT(refused(R"({"from": "a.now", "to": "b.bare_in", "map": {"7": 5}})"),
              HasSubstr("a map needs two Booleans"));
}

TEST(Units, ReportsAConversion) {
  TestRun run(pair("", R"({"from": "a.celsius", "to": "b.kelvin_in"})"));
  EXPECT_THAT(run.system.notices, testing::Contains("a.celsius -> b.kelvin_in: converted from [degC] to [K]"));
}

TEST(Units, AnotherDimensionIsRefusedWithBothBases) {
  EXPECT_THAT(refused(R"({"from": "a.celsius", "to": "b.charge_in"})"),
              AllOf(HasSubstr("a.celsius -> b.charge_in"), HasSubstr("differ in dimension"), HasSubstr("[degC] is K"),
                    HasSubstr("[C] is s.A"), HasSubstr("convert_units")));
}

TEST(Units, AnUndefinedUnitIsRejected) {
  EXPECT_THAT(refused(R"({"from": "a.furlong", "to": "b.speed_in"})"), HasSubstr("does not define [furlong]"));
}

TEST(Units, ADifferenceOfTemperaturesIsNoTemperature) {
  EXPECT_THAT(refused(R"({"from": "a.difference", "to": "b.kelvin_in"})"), HasSubstr("relativeQuantity"));
}

TEST(Units, AVariableWithoutAUnitTakesTheNumberAsItIs) {
  EXPECT_EQ(at_start(pair(R"("celsius": 21.5)", R"({"from": "a.celsius", "to": "b.bare_in"})"), "b.bare_out"), 21.5);
}

TEST(Units, ConversionCanBeSwitchedOff) {
  EXPECT_EQ(at_start(pair(R"("celsius": 21.5)",
                          R"({"from": "a.celsius", "to": "b.charge_in", "convert_units": false, "factor": 2})"),
                     "b.charge_out"),
            43);
}

TEST(Transformation, FactorAndOffsetComeAfterTheConversionOfUnits) {
  // As in SSP 1.0: target = factor * (source in the target's unit) + offset.
  EXPECT_DOUBLE_EQ(
      at_start(pair(R"("celsius": 10)", R"({"from": "a.celsius", "to": "b.kelvin_in", "factor": 2, "offset": -5})"),
               "b.kelvin_out"),
      2 * 283.15 - 5);
}

TEST(Transformation, AnInputThatIsNoRealTakesNone) {
  EXPECT_THAT(refused(R"({"from": "a.count", "to": "b.count_in", "factor": 2})"),
              HasSubstr("need an input of type Real"));
}

TEST(Transformation, AnOverflowIsCaughtWhereItHappens) {
  TestRun run(pair(R"("celsius": 1e300)", R"({"from": "a.celsius", "to": "b.bare_in", "factor": 1e300})"));
  try {
    run.initialize();
    FAIL() << "1e600 is not a double";
  } catch (const NotFiniteError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("instance 'b'"), HasSubstr("'bare_in' would be inf")));
  }
}

TEST(Types, WiderTypesTakeNarrowerOnes) {
  const std::string values = R"("count": -7, "flag": true, "level": "high")";
  const auto real = [&](const std::string& from) {
    return at_start(pair(values, fmt::format(R"({{"from": "a.{}", "to": "b.bare_in"}})", from)), "b.bare_out");
  };
  EXPECT_EQ(real("count"), -7);
  EXPECT_EQ(real("flag"), 1);
  EXPECT_EQ(real("level"), 5);
  for (const char* from : {"flag", "level"}) {
    TestRun run(pair(values, fmt::format(R"({{"from": "a.{}", "to": "b.count_in"}})", from)));
    EXPECT_THAT(run.system.notices, testing::Contains(HasSubstr("becomes Integer")));
    EXPECT_NO_THROW(run.to_end());
  }
  EXPECT_EQ(
      at_start(pair(values, R"({"from": "a.count", "to": "b.bare_in", "factor": 0.5, "offset": 1})"), "b.bare_out"),
      -2.5);
}

TEST(Types, AnIntegerGoesIntoAnEnumerationWhileItIsAnItem) {
  const auto config = [](int value) {
    return pair(fmt::format(R"("count": {})", value), R"({"from": "a.count", "to": "b.level_in"})");
  };
  TestRun run(config(5));
  EXPECT_THAT(run.system.notices, testing::Contains(HasSubstr("Integer becomes Enumeration")));
  EXPECT_NO_THROW(run.to_end());
  TestRun outside(config(3));
  try {
    outside.to_end();
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("instance 'b' at 0 s"), HasSubstr("'level_in' would be 3"),
                                    HasSubstr("it has 1, 5"), HasSubstr("a.count")));
  }
}

TEST(Types, NarrowerTypesDoNotTakeWiderOnes) {
  EXPECT_THAT(refused(R"({"from": "a.bare_out", "to": "b.count_in"})"),
              HasSubstr("the types differ: Real and Integer"));
}

/// Returns a config with a loop x = G(x). a computes the quadratic function G, and b outputs its input.
std::string loop(const std::string& parameters) {
  return fmt::format(
      R"({{"step": 0.1, "stop_time": 0.1, "instances": {{"a": {{"fmu": "COUPLING", "parameters": {{{}}}}}, "b": {{"fmu": "COUPLING", "parameters": {{"b": 1}}}}}},
      "connections": [{{"from": "a.loop_out", "to": "b.loop_in"}}, {{"from": "b.loop_out", "to": "a.loop_in"}}]}})",
      parameters);
}

TEST(InitialLoops, SolvesALinearLoopThatSweepsMakeDiverge) {
  // The loop is x = 4 - 3 x.
  EXPECT_NEAR(at_start(loop(R"("a": 4, "b": -3)"), "b.loop_out"), 1, 1e-11);  // Newton's method stops at 1e-12
}

TEST(InitialLoops, AQuadraticLoopIsSolved) {
  // The loop is x = 1.9 - x^2. Repeated evaluation does not converge, because the slope at both roots has a magnitude
  // above 1.
  const double x = at_start(loop(R"("a": 1.9, "c": -1)"), "b.loop_out");
  EXPECT_NEAR(x + x * x, 1.9, 1e-11);
}

TEST(InitialLoops, ALoopWithoutSolutionIsReportedWithItsPath) {
  TestRun run(loop(R"("a": 1, "b": 1)"));  // the loop x = 1 + x has no solution
  try {
    run.initialize();
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("do not converge"),
                                    HasSubstr("a.loop_in -> a.loop_out -> b.loop_in -> b.loop_out -> a.loop_in")));
  }
}

TEST(GaussSeidel, LaterInstancesSeeWhatEarlierOnesJustPutOut) {
  const auto chain = [](const std::string& algorithm) {
    TestRun run(fmt::format(
        R"({{"step": 0.5, "stop_time": 1.5, {} "instances": {{"a": {{"fmu": "PROBE"}}, "b": {{"fmu": "PROBE"}}}},
        "connections": [{{"from": "a.steps", "to": "b.integer_in"}}]}})",
        algorithm));
    return run.to_end().column("b.integer_out");  // the steps of a that b has received, plus one
  };
  EXPECT_THAT(chain(""), ElementsAre(1, 1, 2, 3));
  EXPECT_THAT(chain(R"("algorithm": "jacobi",)"), ElementsAre(1, 1, 2, 3));
  EXPECT_THAT(chain(R"("algorithm": "gauss-seidel",)"), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(chain(R"("algorithm": {"type": "gauss-seidel", "order": ["b", "a"]},)"), ElementsAre(1, 1, 2, 3));
}

TEST(GaussSeidel, AnInstanceWithALongerStepShowsItsOutputsWhenTheOthersArrive) {
  TestRun run(R"({"step": 0.1, "stop_time": 0.6, "algorithm": {"type": "gauss-seidel", "order": ["slow", "fast"]},
    "instances": {"fast": {"fmu": "PROBE"}, "slow": {"fmu": "PROBE", "step": 0.3}},
    "connections": [{"from": "slow.steps", "to": "fast.integer_in"}], "record": ["slow.steps", "fast.integer_out"]})");
  run.to_end();
  EXPECT_THAT(run.column("slow.steps"), ElementsAre(0, 0, 0, 1, 1, 1, 2));
  EXPECT_THAT(run.column("fast.integer_out"), ElementsAre(1, 1, 1, 2, 2, 2, 3));
}

TEST(GaussSeidel, ARunThatAnFmuEndsShowsTheLastPointThatAllReached) {
  TestRun run(R"({"step": 0.1, "stop_time": 1, "algorithm": "gauss-seidel", "instances": {
    "a": {"fmu": "PROBE"}, "b": {"fmu": "PROBE", "parameters": {"fault": "terminate", "fault_time": 0.5}}},
    "connections": [], "record": {"variables": ["a.steps"], "interval": 0.3}})");
  run.to_end();
  EXPECT_EQ(run.simulation().end().reason, EndReason::terminated);
  EXPECT_THAT(run.column("a.steps"), ElementsAre(0, 3, 4));
}

TEST(GaussSeidel, TheOrderNamesEveryInstanceOnce) {
  const auto error = [](const std::string& order) {
    return test::input_error([&] {
      TestRun(pair("", "", fmt::format(R"(, "algorithm": {{"type": "gauss-seidel", "order": [{}]}})", order)));
    });
  };
  EXPECT_THAT(error(R"("a")"), AllOf(HasSubstr("/algorithm/order"), HasSubstr("missing: b")));
  EXPECT_THAT(error(R"("a", "b", "a")"), HasSubstr("'a' occurs twice"));
  EXPECT_THAT(error(R"("a", "c")"), HasSubstr("no instance 'c'"));
}

TEST(InputDerivatives, AnFmuThatTakesThemGetsThoseOfItsSource) {
  // The area under t^2 from value and slope at the start of each step is t^2 h + t h^2. In each step, it is h^3/3 below
  // the integral. With held values, the area would be 0.285.
  TestRun run(pair("", R"({"from": "a.ramp_out", "to": "b.ramp_in"})", "", R"("step": 0.1, "stop_time": 1)"));
  run.to_end();
  EXPECT_NEAR(run.column("b.ramp_area").back(), 1.0 / 3 - 10 * 0.001 / 3, 1e-15 * 10);
}

TEST(InputDerivatives, OnesThatAreNoNumbersLeaveTheInputHeldWithOneNotice) {
  TestRun run(pair(R"("behaviour": "nan_slope")", R"({"from": "a.ramp_out", "to": "b.ramp_in"})", "",
                   R"("step": 0.1, "stop_time": 1)"));
  run.to_end();
  EXPECT_NEAR(run.column("b.ramp_area").back(), 0.285, 1e-15 * 10);  // area if t^2 is held in each step
  EXPECT_EQ(
      std::ranges::count_if(run.messages.lines,
                            [](const std::string& line) {
                              return line.starts_with("/notice: a.ramp_out -> b.ramp_in: the derivative of order 1");
                            }),
      1);
}

/// Simulates two masses with a spring between them. Each FMU integrates its mass exactly. Returns the largest error of
/// both positions over 5 s. The exact solution is x = (cos(sqrt(10) t) +- cos(sqrt(30) t)) / 2.
double error_of_two_masses(const test::ChangedFmu& fmu, const std::string& algorithm, int steps_per_second) {
  TestRun run(fmt::format(
      R"({{"step": {}, "stop_time": 5, "algorithm": "{}", "instances": {{"a": {{"fmu": "{}", "parameters": {{"mass_x": 1}}}}, "b": {{"fmu": "{}"}}}},
      "connections": [{{"from": "a.mass_x", "to": "b.mass_u"}}, {{"from": "b.mass_x", "to": "a.mass_u"}}], "record": ["*.mass_x"]}})",
      1.0 / steps_per_second, algorithm, fmu.path().string(), fmu.path().string()));
  run.to_end();
  const auto a = run.column("a.mass_x");
  const auto b = run.column("b.mass_x");
  double largest = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const double t = static_cast<double>(k) / steps_per_second;
    const double sum = std::cos(std::sqrt(10) * t);
    const double difference = std::cos(std::sqrt(30) * t);
    largest = std::max({largest, std::abs(a[k] - (sum + difference) / 2), std::abs(b[k] - (sum - difference) / 2)});
  }
  return largest;
}

TEST(CouplingOrder, DerivativesMakeJacobiAndGaussSeidelSecondOrder) {
  for (const int orders : {0, 1}) {
    const test::ChangedFmu fmu("coupling", R"(maxOutputDerivativeOrder="2")",
                               fmt::format(R"(maxOutputDerivativeOrder="{}")", orders));
    for (const char* algorithm : {"jacobi", "gauss-seidel"}) {
      const double coarse = error_of_two_masses(fmu, algorithm, 200);
      const double fine = error_of_two_masses(fmu, algorithm, 800);
      const double order = std::log(coarse / fine) / std::log(4.0);
      EXPECT_NEAR(order, orders + 1, 0.15)
          << algorithm << " with derivatives up to order " << orders << ": " << coarse << " and " << fine;
    }
  }
}

TEST(InputDerivatives, AnInputWithTwoKnownEndsFollowsALine) {
  // b steps after a and receives t^2 at both ends of its step. The result is that of the trapezoidal rule, h^2/6 above
  // 1/3.
  TestRun run(pair("", R"({"from": "a.ramp_out", "to": "b.ramp_in"})", R"(, "algorithm": "gauss-seidel")",
                   R"("step": 0.1, "stop_time": 1)"));
  run.to_end();
  EXPECT_NEAR(run.column("b.ramp_area").back(), 1.0 / 3 + 0.01 / 6, 1e-14);
}

TEST(InputDerivatives, TheyAreScaledAsTheValueIs) {
  TestRun run(pair("", R"({"from": "a.ramp_out", "to": "b.ramp_in", "factor": 3, "offset": 1})", "",
                   R"("step": 0.1, "stop_time": 1)"));
  run.to_end();
  EXPECT_NEAR(run.column("b.ramp_area").back(), 3 * (1.0 / 3 - 10 * 0.001 / 3) + 1, 1e-14);
}

TEST(InputDerivatives, AnOverriddenVariableHasTheDerivativesOfItsOverride) {
  // The output is t^2 with slope 2 t. The override begins at 0.5 s.
  const auto area = [](const std::string& variable, const std::string& action) {
    TestRun run(pair("", R"({"from": "a.ramp_out", "to": "b.ramp_in"})",
                     fmt::format(R"(, "scenario": [{{"variable": "{}", "from": 0.5, {}}}])", variable, action),
                     R"("step": 0.1, "stop_time": 1)"));
    run.to_end();
    const auto column = run.column("b.ramp_area");
    return column.back() - column[5];
  };
  for (const auto* variable : {"a.ramp_out", "b.ramp_in"}) {
    EXPECT_NEAR(area(variable, R"("set": 3)"), 1.5, 1e-12) << variable;
    EXPECT_NEAR(area(variable, R"("freeze": true)"), 0.125, 1e-12) << variable;
    // The area under a line from 0.25 with slope 2.
    EXPECT_NEAR(area(variable, R"("ramp": 1.25, "over": 0.5)"), 0.125 + 0.25, 1e-12) << variable;
  }
  const double plain = area("b.bare_in", R"("set": 0)");
  EXPECT_NEAR(area("a.ramp_out", R"("scale": 2)"), 2 * plain, 1e-12);
}

TEST(Pending, APendingStepIsWaitedFor) {
  for (const char* behaviour : {"callback", "poll"}) {
    TestRun run(pair(fmt::format(R"("behaviour": "{}", "pause": 0.002)", behaviour), ""));
    run.to_end();
    EXPECT_THAT(run.column("a.steps"), ElementsAre(0, 1, 2)) << behaviour;
    EXPECT_THAT(run.column("a.now"), ElementsAre(0, 0.1, 0.2)) << behaviour;
  }
}

/// The callback of the first step arrives during the second step and must not end it.
TEST(Pending, ACallbackOfTheStepBeforeDoesNotEndAStep) {
  TestRun run(pair(R"("behaviour": "stale", "pause": 0.005)", ""));
  run.to_end();
  EXPECT_THAT(run.column("a.steps"), ElementsAre(0, 1, 2));
}

TEST(Pending, ACallbackCountsIfTheStatusStaysPending) {
  TestRun run(pair(R"("behaviour": "denied")", ""));
  run.to_end();
  EXPECT_THAT(run.column("a.steps"), ElementsAre(0, 1, 2));
  EXPECT_THAT(run.messages.lines, testing::Contains(HasSubstr("fmi2GetStatus reports a pending step")).Times(1));
}

TEST(Pending, ADiscardThatComesLateIsADiscard) {
  TestRun run(pair(R"("behaviour": "late_discard")", ""));
  try {
    run.to_end();
    FAIL();
  } catch (const SlaveError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("instance 'a' at 0 s"), HasSubstr("fmi2Discard")));
  }
}

/// Interrupts a run from another thread after 20 ms.
std::jthread interrupt_soon(TestRun& run) {
  return std::jthread([&run] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    run.interrupted = true;
  });
}

TEST(Pending, AnInterruptCancelsAStepThatNeverEnds) {
  TestRun run(pair(R"("behaviour": "never")", ""));
  run.initialize();
  const auto user = interrupt_soon(run);
  EXPECT_EQ(run.simulation().run().reason, EndReason::interrupted);
  EXPECT_NO_THROW(run.simulation().terminate());
}

std::string uncancellable(const std::string& parameters) {
  return fmt::format(
      R"({{"step": 0.1, "stop_time": 0.2, "instances": {{"a": {{"fmu": "{}", "parameters": {{{}}}}}}}, "connections": []}})",
      UNCANCELLABLE_FMU, parameters);
}

TEST(Pending, AnInterruptWaitsForAStepThatTheFmuCannotCancel) {
  TestRun run(uncancellable(R"("behaviour": "callback", "pause": 0.05)"));
  run.initialize();
  const auto user = interrupt_soon(run);
  EXPECT_EQ(run.simulation().run().reason, EndReason::interrupted);
  EXPECT_EQ(run.simulation().time_ns(), 100'000'000) << "the step was finished";
  EXPECT_NO_THROW(run.simulation().terminate());
}

TEST(Pending, AnInstanceWhoseStepCannotBeEndedIsNeitherTerminatedNorFreed) {
  TestRun run(uncancellable(R"("behaviour": "never")"));
  run.initialize();
  const auto user = interrupt_soon(run);
  const auto& end = run.simulation().run();
  EXPECT_EQ(end.reason, EndReason::interrupted);
  EXPECT_THAT(end.text, AllOf(HasSubstr("instance 'a'"), HasSubstr("the FMU has no fmi2CancelStep")));
  EXPECT_NO_THROW(run.simulation().terminate());
}

/// Allocates memory for `seconds`, so that memory of freed slaves is used again.
void reuse_freed_memory(double seconds) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (std::chrono::steady_clock::now() < until) {
    std::vector<std::string> blocks;
    for (std::size_t size = 16; size <= 4 * sizeof(Fmi2Slave); size += 16) blocks.emplace_back(size, '\x55');
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

TEST(Pending, AnInstanceThatIsNotFreedKeepsItsCallbacks) {
  {
    TestRun run(uncancellable(R"("behaviour": "never")"));
    run.initialize();
    const auto user = interrupt_soon(run);
    EXPECT_EQ(run.simulation().run().reason, EndReason::interrupted);
  }
  reuse_freed_memory(0.05);  // the step still runs and logs
}

TEST(Pending, AStepThatTheFmuDidNotCancelContinues) {
  TestRun run(pair(R"("behaviour": "stubborn")", ""));
  run.initialize();
  const auto user = interrupt_soon(run);
  const auto& end = run.simulation().run();
  EXPECT_EQ(end.reason, EndReason::interrupted);
  EXPECT_THAT(end.text, AllOf(HasSubstr("instance 'a'"), HasSubstr("fmi2CancelStep returned fmi2Error")));
  EXPECT_NO_THROW(run.simulation().terminate());
}

class FailingSink final : public MessageSink {
 public:
  void message(const Message& /*message*/) override { throw std::runtime_error("the listener failed"); }
};

TEST(Pending, AnInstanceIsDestroyedAlthoughItsStepCannotBeEnded) {
  FailingSink sink;
  Fmi2Slave slave("a", std::make_shared<Fmu>(UNCANCELLABLE_FMU), {}, sink);
  const auto behaviour = std::ranges::find(slave.description().variables, "behaviour", &modeldesc::Variable::name);
  const ValueReference reference[] = {behaviour->value_reference};
  const std::string value[] = {"broken"};
  slave.setup_experiment({});
  slave.set_strings(reference, value);
  slave.enter_initialization();
  slave.exit_initialization();
  EXPECT_TRUE(slave.step(0, 100'000'000).pending);
}  // the exception must not end the process

TEST(Discard, AStepIsDividedWhereTheConfigAllows) {
  const auto config = [](const std::string& more) {
    return fmt::format(
        R"({{"step": 0.1, "stop_time": 0.2, "instances": {{"a": {{"fmu": "COUPLING", "parameters": {{"behaviour": "short", "max_step": 0.025}}{}}}}}, "connections": []}})",
        more);
  };
  TestRun run(config(R"(, "on_discard": "divide")"));
  run.to_end();
  EXPECT_THAT(run.column("a.steps"), ElementsAre(0, 4, 8));
  EXPECT_NEAR(run.column("a.now").back(), 0.2, 1e-15);  // the FMU itself adds t and h
  TestRun undivided(config(""));
  try {
    undivided.to_end();
    FAIL();
  } catch (const SlaveError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("after reaching 0.025 s"), HasSubstr("on_discard")));
  }
}

TEST(Discard, DividingEndsAtTheShortestStep) {
  TestRun run(
      R"({"step": 0.1, "stop_time": 0.2, "instances": {"a": {"fmu": "COUPLING", "parameters": {"behaviour": "refuse"}, "on_discard": "divide"}}, "connections": []})");
  EXPECT_THAT([&] { run.to_end(); }, testing::ThrowsMessage<SlaveError>(Not(HasSubstr("on_discard"))));
}

}  // namespace
}  // namespace mebots::master
