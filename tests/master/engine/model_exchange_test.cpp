// SPDX-License-Identifier: Apache-2.0
// Tests model exchange instances in a system, with tests/fmus/mass.c.
#include "test_system.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

namespace mebots::master {
namespace {

using test::TestRun;
using testing::AllOf;
using testing::Each;
using testing::HasSubstr;

/// Returns a config of masses. `instances` and `connections` are parts of its JSON.
std::string system_of(const std::string& instances, const std::string& connections = "", const std::string& more = "",
                      const std::string& times = R"("step": 0.1, "stop_time": 2)") {
  return fmt::format(R"({{{}, "instances": {{{}}}, "connections": [{}]{}}})", times, instances, connections, more);
}

std::string mass(const std::string& name, const std::string& parameters, const std::string& more = "") {
  return fmt::format(R"("{}": {{"fmu": "{}", "parameters": {{{}}}{}}})", name, MASS_FMU, parameters, more);
}

std::string exchange_refused(const std::string& config) {
  return test::input_error([&] { TestRun run(config); });
}

/// Two masses on springs of stiffness 1, with a spring of stiffness 3 between them. a receives the force of b, and b
/// receives the position of a.
const std::string kPair = mass("a", R"("x": 1)") + ", " + mass("b", R"("grip": 3)");
const std::string kOwnProcess = R"(, "process": "own")";
const std::string kPairConnections = R"({"from": "b.pull", "to": "a.force"}, {"from": "a.x", "to": "b.other_x"})";

TEST(ModelExchange, IntegratesOneInstanceExactly) {
  const auto x = TestRun(system_of(mass("a", R"("x": 1, "stiffness": 4)"))).to_end().column("a.x");
  ASSERT_EQ(x.size(), 21U);
  for (std::size_t k = 0; k < x.size(); ++k) EXPECT_NEAR(x[k], std::cos(0.2 * static_cast<double>(k)), 1e-6) << k;
}

TEST(ModelExchange, EvaluatesConnectionsAtEveryStepOfTheSolver) {
  // The sum oscillates with the frequency sqrt(1), and the difference with sqrt(1 + 2 * 3), for any communication step.
  for (const auto* times : {R"("step": 0.1, "stop_time": 2)", R"("step": 2, "stop_time": 2)"}) {
    TestRun run(system_of(kPair, kPairConnections, "", times));
    EXPECT_EQ(run.system.continuous_systems.size(), 1U);
    const auto a = run.to_end().column("a.x").back();
    const auto b = run.column("b.x").back();
    EXPECT_NEAR(a + b, std::cos(2.0), 1e-6) << times;
    EXPECT_NEAR(a - b, std::cos(std::sqrt(7.0) * 2), 1e-6) << times;
  }
}

TEST(ModelExchange, HasTheSameBitsInAnyAlgorithmOrderAndThread) {
  const auto csv = [&](const std::string& instances, const std::string& more) {
    return TestRun(system_of(instances, kPairConnections, more)).to_end().column("a.x");
  };
  const auto jacobi = csv(kPair, "");
  EXPECT_EQ(csv(kPair, R"(, "algorithm": "gauss-seidel")"), jacobi);
  EXPECT_EQ(csv(kPair, R"(, "algorithm": {"type": "gauss-seidel", "order": ["b", "a"]})"), jacobi);
  EXPECT_EQ(csv(kPair, R"(, "threads": 4)"), jacobi);
}

TEST(ModelExchange, HandlesStateAndTimeEventsAndCountsThem) {
  // The mass reverses at x = 0.5 at the time asin(0.5) = pi / 6, and returns to 0 at pi / 3. A kick at 1.55 s adds 2 to
  // the speed.
  const auto config = system_of(mass("a", R"("v": 1, "wall": 0.5, "kick": 2, "kick_time": 1.55)"));
  TestRun run(config);
  const auto x = run.to_end().column("a.x");
  const double turned_s = std::numbers::pi / 6;
  const auto swing = [&](double t) { return t < turned_s ? std::sin(t) : std::sin(2 * turned_s - t); };
  for (int k = 0; k <= 15; ++k) EXPECT_NEAR(x[static_cast<std::size_t>(k)], swing(0.1 * k), 1e-6) << k;
  const double v = -std::cos(2 * turned_s - 1.55) + 2;
  EXPECT_NEAR(x[20], swing(1.55) * std::cos(0.45) + v * std::sin(0.45), 1e-6);
  EXPECT_EQ(run.column("a.hits").back(), 1);
}

TEST(ModelExchange, ADiscreteInputIsAnEventAtItsPoint) {
  const auto scenario = R"(, "scenario": [{"variable": "a.brake", "set": true, "from": 1}])";
  TestRun run(system_of(mass("a", R"("v": 1)"), "", scenario));
  const auto x = run.to_end().column("a.x");
  EXPECT_NEAR(x[10], std::sin(1.0), 1e-6);
  EXPECT_NEAR(x[20], std::sin(1.0), 1e-6);
  EXPECT_EQ(run.column("a.stopped")[20], 1);
}

TEST(ModelExchange, PassesDiscreteValuesOnWithinOneEvent) {
  TestRun run(system_of(mass("a", "") + ", " + mass("b", R"("v": 1)"), R"({"from": "a.stopped", "to": "b.brake"})",
                        R"(, "scenario": [{"variable": "a.brake", "set": true, "from": 1}])"));
  const auto x = run.to_end().column("b.x");
  EXPECT_NEAR(x[20], std::sin(1.0), 1e-6);
}

TEST(ModelExchange, FollowsTheSlopesOfInputsFromFiles) {
  // x'' = t from rest gives x = t^3 / 6. Within a step, the solver must follow the slope of the force, which is known
  // only at communication points.
  modeldesc::TemporaryFolder folder{"mebots-test"};
  test::write_file(folder.path() / "force.csv", "time,a.force\n0,0\n2,2\n");
  const auto inputs = fmt::format(R"(, "inputs": {{"file": "{}"}})", (folder.path() / "force.csv").string());
  TestRun run(system_of(mass("a", R"("stiffness": 0)"), "", inputs, R"("step": 0.5, "stop_time": 2)"));
  const auto x = run.to_end().column("a.x");
  for (std::size_t k = 0; k < x.size(); ++k) EXPECT_NEAR(x[k], std::pow(0.5 * static_cast<double>(k), 3) / 6, 1e-6);
}

TEST(ModelExchange, HoldsAnOverriddenConnectionAtPoints) {
  const auto scenario = R"(, "scenario": [{"variable": "a.force", "scale": 1.0, "from": 1}])";
  TestRun held(system_of(kPair, kPairConnections, scenario));
  const auto first =
      std::ranges::find_if(held.system.connections, [](const auto& c) { return c.to.variable->name == "force"; });
  ASSERT_NE(first, held.system.connections.end());
  EXPECT_FALSE(first->inner);
  const auto exact = TestRun(system_of(kPair, kPairConnections)).to_end().column("a.x").back();
  const auto got = held.to_end().column("a.x").back();
  EXPECT_NE(got, exact);
  EXPECT_NEAR(got, exact, 0.3);
}

TEST(ModelExchange, EndsTheRunWhereAnInstanceRequestsIt) {
  TestRun run(system_of(mass("a", R"("v": 1, "wall": 0.5, "last_hit": 1)") + ", " + mass("b", R"("x": 1)"),
                        R"({"from": "a.x", "to": "b.other_x"})"));
  run.to_end();
  EXPECT_EQ(run.simulation().end().reason, EndReason::terminated);
  EXPECT_THAT(run.simulation().end().text, HasSubstr("0.5235987"));
  EXPECT_EQ(run.column("a.x").size(), 6U);
}

TEST(ModelExchange, NamesInstanceAndStateOfADerivativeThatIsNoNumber) {
  for (const auto& process : {std::string(), kOwnProcess}) {
    TestRun run(system_of(mass("a", R"("x": 1, "nan_time": 0.73)", process)));
    try {
      run.to_end();
      FAIL() << "no step leads over the time of the NaN";
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), AllOf(HasSubstr("instance 'a'"), HasSubstr("derivative of the state 'v'")));
      EXPECT_EQ(error.code(), ErrorCode::not_finite);
    }
  }
}

TEST(ModelExchange, HasTheSameBitsInAProcessOfItsOwn) {
  const auto x = [](const std::string& of_a, const std::string& of_b) {
    const auto instances = mass("a", R"("x": 1, "wall": 0.9, "v": 0.5, "kick": 2, "kick_time": 1.55)", of_a) + ", " +
                           mass("b", R"("grip": 3)", of_b);
    const auto brake = R"({"from": "a.stopped", "to": "b.brake"}, )";
    const auto scenario = R"(, "scenario": [{"variable": "a.brake", "set": true, "from": 1.8}])";
    return TestRun(system_of(instances, brake + kPairConnections, scenario)).to_end().column("b.x");
  };
  const auto here = x("", "");
  EXPECT_EQ(x(kOwnProcess, ""), here);
  EXPECT_EQ(x(kOwnProcess, kOwnProcess), here);
}

TEST(ModelExchange, RefusesDifferentStepsInOneSystem) {
  const auto instances = mass("a", "") + ", " + mass("b", "", R"(, "step": 0.2)");
  EXPECT_THAT(exchange_refused(system_of(instances, kPairConnections)),
              AllOf(HasSubstr("/instances/b/step"), HasSubstr("0.1 s and 0.2 s")));
  EXPECT_EQ(TestRun(system_of(instances)).to_end().column("a.x").size(), 21U);  // two separate systems
}

TEST(ModelExchange, RefusesWhatNoMemberCanHave) {
  EXPECT_THAT(exchange_refused(system_of(mass("a", "", R"(, "on_discard": "divide")"))),
              HasSubstr("/instances/a/on_discard"));
  EXPECT_THAT(exchange_refused(
                  system_of(mass("a", "") + ", " + mass("b", "", R"(, "on_failure": "continue")"), kPairConnections)),
              HasSubstr("/instances/b/on_failure"));
  EXPECT_THAT(exchange_refused(system_of(mass("a", "", R"(, "solver": {"method": "adams"})") + ", " +
                                             mass("b", "", R"(, "solver": {"method": "bdf"})"),
                                         kPairConnections)),
              HasSubstr("/instances/b/solver"));
  EXPECT_THAT(exchange_refused(system_of(mass("a", "", R"(, "kind": "co_simulation")"))),
              HasSubstr("does not offer <CoSimulation>"));
}

TEST(ModelExchange, TakesTolerancesAndLimitsOfTheSolver) {
  const auto error = [](const std::string& solver) {
    const auto x = TestRun(system_of(mass("a", R"("x": 1)"), "", R"(, "solver": )" + solver)).to_end().column("a.x");
    return std::abs(x.back() - std::cos(2.0));
  };
  EXPECT_GT(error(R"({"relative_tolerance": 1e-3})"), 10 * error(R"({"relative_tolerance": 1e-9})"));
  EXPECT_LT(error(R"({"method": "adams"})"), 1e-6);
  TestRun limited(system_of(mass("a", R"("x": 1)"), "", R"(, "solver": {"max_steps": 3})"));
  EXPECT_THROW(limited.to_end(), Error);
}

/// Runs to the end. At the points in `stops`, saves the state as bytes and continues in a new run.
std::string csv_with_stops(const std::string& config, const std::vector<std::int64_t>& stops,
                           std::vector<std::string>* messages = nullptr) {
  auto run = std::make_unique<TestRun>(config);
  run->initialize();
  std::string rows;
  const auto x = [](TestRun& r) {
    std::string text;
    for (const auto* name : {"a.x", "b.x", "a.hits"}) text += fmt::format("{} ", r.column(name).back());
    return text;
  };
  while (!run->simulation().ended()) {
    run->simulation().step();
    rows += x(*run) + "\n";
    if (std::ranges::find(stops, run->simulation().steps_done()) == stops.end()) continue;
    const auto bytes = run->simulation().serialize(run->simulation().save_state());
    run = std::make_unique<TestRun>(config);
    run->simulation().resume(bytes);
  }
  if (messages != nullptr) *messages = run->messages.lines;
  return rows;
}

TEST(ModelExchange, ContinuesWithTheSameBitsFromASavedState) {
  const auto config = system_of(mass("a", R"("x": 1, "wall": 0.9, "v": 0.5)") + ", " + mass("b", R"("grip": 3)"),
                                kPairConnections, R"(, "solver": {"max_step": 0.3})");
  const auto straight = csv_with_stops(config, {});
  EXPECT_EQ(csv_with_stops(config, {1}), straight);
  EXPECT_EQ(csv_with_stops(config, {3, 4, 11}), straight);
  EXPECT_EQ(csv_with_stops(config, {7, 19}), straight);
  const auto own = system_of(
      mass("a", R"("x": 1, "wall": 0.9, "v": 0.5)", kOwnProcess) + ", " + mass("b", R"("grip": 3)", kOwnProcess),
      kPairConnections, R"(, "solver": {"max_step": 0.3})");
  EXPECT_EQ(csv_with_stops(own, {7}), straight);
}

TEST(ModelExchange, ReportsThatStepsCannotBeRepeated) {
  const auto instances = mass("a", R"("x": 1, "impure": true)") + ", " + mass("b", R"("grip": 3)");
  std::vector<std::string> messages;
  csv_with_stops(system_of(instances, kPairConnections), {7}, &messages);
  EXPECT_THAT(messages, testing::Contains(HasSubstr("the solver restarts at 0.7")));
  const auto exact = R"(, "solver": {"restart_at_points": true})";
  csv_with_stops(system_of(instances, kPairConnections, exact), {7}, &messages);
  EXPECT_THAT(messages, Each(testing::Not(HasSubstr("the solver restarts"))));
}

TEST(ModelExchange, PutsTheSolversWorkIntoTheSummary) {
  modeldesc::TemporaryFolder folder{"mebots-test"};
  test::write_file(folder.path() / "pair.json", system_of(kPair, kPairConnections));
  const auto result = test::run_program({"run", "pair.json", "--out", "out"}, folder.path());
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("solver of a, b: "));
  const auto summary = nlohmann::json::parse(test::read_file(folder.path() / "out" / "summary.json"));
  const auto& solver = summary.at("solvers").at(0);
  EXPECT_EQ(solver.at("instances"), nlohmann::json({"a", "b"}));
  EXPECT_EQ(solver.at("states"), 4);
  EXPECT_EQ(solver.at("relative_tolerance"), 1e-8);
  EXPECT_EQ(solver.at("restarts"), 1);
  EXPECT_GT(solver.at("steps"), 20);
  EXPECT_GT(solver.at("evaluations"), solver.at("steps"));
}

}  // namespace
}  // namespace mebots::master
