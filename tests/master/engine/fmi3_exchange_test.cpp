// SPDX-License-Identifier: Apache-2.0
// Tests model exchange of FMI 3.0 with tests/fmus/springs.cpp. A structural parameter determines its number of masses.
#include "test_system.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "fmi/fmu.hpp"
#include "slave/fmi/make_slave.hpp"

#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

namespace mebots::master {
namespace {

using test::TestRun;
using testing::HasSubstr;

std::string springs(const std::string& name, const std::string& parameters, const std::string& more = "") {
  return fmt::format(R"("{}": {{"fmu": "{}", "parameters": {{{}}}{}}})", name, SPRINGS_FMU, parameters, more);
}

std::string springs_system(const std::string& instances, const std::string& connections = "") {
  return fmt::format(R"({{"step": 0.1, "stop_time": 2, "instances": {{{}}}, "connections": [{}]}})", instances,
                     connections);
}

TEST(Fmi3ModelExchange, IntegratesArraysOfTheConfiguredSize) {
  TestRun run(springs_system(springs("a", R"("count": 2, "stiffness": 4, "x[1]": 1, "x[2]": 0, "v[2]": 2)")));
  run.to_end();
  const auto first = run.column("a.x[1]");
  const auto second = run.column("a.x[2]");
  ASSERT_EQ(first.size(), 21U);
  for (std::size_t k = 0; k < first.size(); ++k) {
    EXPECT_NEAR(first[k], std::cos(0.2 * static_cast<double>(k)), 1e-6) << k;
    EXPECT_NEAR(second[k], std::sin(0.2 * static_cast<double>(k)), 1e-6) << k;
  }
}

TEST(Fmi3ModelExchange, EvaluatesConnectionsOfArraysAtEveryStepOfTheSolver) {
  // The position x = cos t of a is the force on b, at the natural frequency of b. Each element of b moves as y = t
  // sin(t) / 2 times the amplitude.
  const auto a = springs("a", R"("count": 2, "x[1]": 1, "x[2]": -2)");
  const auto b = springs("b", R"("count": 2, "x[1]": 0, "x[2]": 0)");
  TestRun run(springs_system(a + ", " + b, R"({"from": "a.x", "to": "b.force", "convert_units": false})"));
  EXPECT_EQ(run.system.continuous_systems.size(), 1U);
  run.to_end();
  EXPECT_NEAR(run.column("b.x[1]").back(), std::sin(2.0), 1e-6);
  EXPECT_NEAR(run.column("b.x[2]").back(), -2 * std::sin(2.0), 1e-6);
}

TEST(Fmi3ModelExchange, HasTheSameBitsInAProcessOfItsOwn) {
  const auto x = [](const std::string& more) {
    const auto a = springs("a", R"("count": 2, "x[1]": 1, "x[2]": -2, "wall": 0.9)", more);
    const auto b = springs("b", R"("count": 2, "x[1]": 0, "x[2]": 0)", more);
    TestRun run(springs_system(a + ", " + b, R"({"from": "a.x", "to": "b.force", "convert_units": false})"));
    return run.to_end().column("b.x[2]");
  };
  EXPECT_EQ(x(R"(, "process": "own")"), x(""));
}

TEST(Fmi3ModelExchange, TakesDirectionalDerivativesOfArrays) {
  test::Messages messages;
  const auto fmu = std::make_shared<Fmu>(SPRINGS_FMU);
  auto [slave, instance] = make_continuous_here({"a", fmu, {{0, 2}}, {}, {}}, messages);  // two masses
  slave->setup_experiment({});
  slave->enter_initialization();
  slave->exit_initialization();
  ASSERT_TRUE(instance->has_directional_derivatives());
  const auto reference = [&](const char* name) { return slave->description().find(name)->value_reference; };
  const auto change = [&](const char* known) {
    std::vector<double> changes(4);
    instance->directional_derivatives(instance->derivative_references(), std::vector{reference(known)},
                                      std::vector{2.0}, changes);
    return changes;
  };
  // x' = v and v' = -x + force, in the order x[1], x[2], v[1], v[2].
  EXPECT_THAT(change("x[2]"), testing::ElementsAre(0, 0, 0, -2));
  EXPECT_THAT(change("v[1]"), testing::ElementsAre(2, 0, 0, 0));
  EXPECT_THAT(change("force[1]"), testing::ElementsAre(0, 0, 2, 0));
}

TEST(Fmi3ModelExchange, FindsStateEvents) {
  // x = -cos 2t reaches 0.5 at pi / 3.
  TestRun run(springs_system(springs("a", R"("x[1]": -1, "wall": 0.5, "stiffness": 4)")));
  run.to_end();
  EXPECT_EQ(run.column("a.hits").back(), 1);
  EXPECT_NEAR(run.column("a.hit_time").back(), std::numbers::pi / 3, 1e-6);
}

TEST(Fmi3ModelExchange, NamesTheInstanceWhoseDerivativesAreDiscarded) {
  TestRun run(springs_system(springs("a", R"("x[1]": 0, "v[1]": 1, "domain": 0.5)")));
  try {
    run.to_end();
    FAIL() << "the mass leaves its domain at pi / 6";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("instance 'a' cannot compute its derivatives"));
  }
}

}  // namespace
}  // namespace mebots::master
