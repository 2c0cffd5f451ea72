// SPDX-License-Identifier: Apache-2.0
// Model exchange of FMI 3.0: tests/fmus/springs.cpp, masses on springs. Their number is a structural parameter.
#include "test_system.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <string>

namespace mebots::master {
namespace {

using test::TestRun;
using testing::HasSubstr;

std::string springs(const std::string& name, const std::string& parameters) {
  return fmt::format(R"("{}": {{"fmu": "{}", "parameters": {{{}}}}})", name, SPRINGS_FMU, parameters);
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
  // x = cos t of a drives b at its own frequency: y = t sin(t) / 2 for each element.
  const auto a = springs("a", R"("count": 2, "x[1]": 1, "x[2]": -2)");
  const auto b = springs("b", R"("count": 2, "x[1]": 0, "x[2]": 0)");
  TestRun run(springs_system(a + ", " + b, R"({"from": "a.x", "to": "b.force", "convert_units": false})"));
  EXPECT_EQ(run.system.continuous_systems.size(), 1U);
  run.to_end();
  EXPECT_NEAR(run.column("b.x[1]").back(), std::sin(2.0), 1e-6);
  EXPECT_NEAR(run.column("b.x[2]").back(), -2 * std::sin(2.0), 1e-6);
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
