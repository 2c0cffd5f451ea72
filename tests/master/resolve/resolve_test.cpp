// SPDX-License-Identifier: Apache-2.0
#include "resolve/resolve.hpp"
#include "io/config/command_line.hpp"
#include "io/config/load_system.hpp"
#include "model/resolved_system.hpp"
#include "test_system.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

namespace mebots::master {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

std::string two_probes(const std::string& parameters, const std::string& connections, const std::string& steps = "") {
  return fmt::format(R"({{"step": 0.1, "stop_time": 1.2,
    "instances": {{"a": {{"fmu": "PROBE", "parameters": {{{}}}}}, "b": {{"fmu": "PROBE"{}}}}},
    "connections": [{}]}})",
                     parameters, steps, connections);
}

std::string error_of(const std::string& parameters, const std::string& connections = "",
                     const std::string& steps = "") {
  return test::input_error([&] { test::TestRun run(two_probes(parameters, connections, steps)); });
}

std::string connecting(const std::string& from, const std::string& to) {
  return error_of("", fmt::format(R"({{"from": "a.{}", "to": "b.{}"}})", from, to));
}

TEST(Parameters, ATextEndsAtNoZeroByte) {
  EXPECT_THAT(error_of(R"("string_in": "a\u0000b")"),
              AllOf(HasSubstr("/instances/a/parameters/string_in"), HasSubstr("contains a zero byte")));
}

TEST(Connections, AnUnknownVariableIsAnsweredByTheNearestOne) {
  EXPECT_THAT(connecting("real_oot", "real_in"),
              AllOf(HasSubstr("/connections/0/from"), HasSubstr("no variable 'real_oot'"), HasSubstr("'real_out'")));
  EXPECT_THAT(connecting("real_out", "real_inn"), AllOf(HasSubstr("/connections/0/to"), HasSubstr("'real_in'")));
}

TEST(Connections, TypesMustAgree) {
  EXPECT_THAT(connecting("real_out", "integer_in"), HasSubstr("the types differ: Real and Integer"));
  EXPECT_THAT(connecting("boolean_out", "mode_in"), HasSubstr("the types differ: Boolean and Enumeration"));
  EXPECT_THAT(connecting("colour_out", "mode_in"),
              AllOf(HasSubstr("enumerations differ"), HasSubstr("green = 1"), HasSubstr("both = 7")));
}

TEST(Connections, AValueThatAConnectionWouldOverwriteIsRefusedWithItsSource) {
  EXPECT_THAT(
      test::input_error([] {
        test::TestRun(R"({"step": 0.1, "stop_time": 1, "instances": {"a": {"fmu": "PROBE"},
                  "b": {"fmu": "PROBE", "parameters": {"real_in": 3}}}, "connections": [{"from": "a.real_out", "to": "b.real_in"}]})");
      }),
      AllOf(HasSubstr("/instances/b/parameters/real_in"), HasSubstr("'b.real_in' gets its value from a.real_out")));
}

TEST(Connections, UnitsMustAgree) {
  EXPECT_THAT(connecting("integral", "real_in"),
              AllOf(HasSubstr("a.integral -> b.real_in"), HasSubstr("[m.s] is m.s and [m] is m")));
}

TEST(Connections, TwoNamesOfOneUnitAgree) {
  const test::TestRun run(two_probes("", R"({"from": "a.real_out", "to": "b.real_in"})"));  // metre and m
  EXPECT_EQ(run.system.connections.size(), 1u);
}

TEST(Connections, RunFromOutputToInput) {
  EXPECT_THAT(connecting("real_in", "real_in"), HasSubstr("'real_in' has causality input"));
  EXPECT_THAT(connecting("offset", "real_in"), HasSubstr("'offset' has causality parameter"));
  EXPECT_THAT(connecting("real_out", "real_out"), HasSubstr("must end at an input"));
}

TEST(Connections, AnInputHasOneSource) {
  EXPECT_THAT(
      error_of("", R"({"from": "a.real_out", "to": "b.real_in"}, {"from": "b.real_out", "to": "b.real_in"})"),
      AllOf(HasSubstr("/connections/1"), HasSubstr("'b.real_in' has two sources"), HasSubstr("/connections/0")));
}

TEST(Connections, ABinaryVariableIsConnectedAsOne) {
  const test::TestRun run(two_probes("", R"({"from": "a.buffer", "to": "b.taken"})"));
  ASSERT_EQ(run.system.connections.size(), 3u);
  for (const auto& connection : run.system.connections) EXPECT_TRUE(connection.pointer);
  EXPECT_EQ(run.system.text(run.system.connections[2].to), "b.taken.size");
}

TEST(Connections, ABinaryVariableAndAScalarDoNotFit) {
  EXPECT_THAT(connecting("buffer", "integer_in"), HasSubstr("'a.buffer' is a binary variable"));
  EXPECT_THAT(connecting("buffer", "nothing"), HasSubstr("no variable 'nothing'"));
}

TEST(Connections, AReaderOfABufferMayNotStepMoreOftenThanItsOwner) {
  EXPECT_THAT(error_of("", R"({"from": "b.buffer", "to": "a.taken"})", R"(, "step": 0.2)"),
              HasSubstr("must be a multiple"));
  EXPECT_NO_THROW(test::TestRun(two_probes("", R"({"from": "a.buffer", "to": "b.taken"})", R"(, "step": 0.2)")));
}

TEST(StartValues, AnUnknownVariableIsAnsweredByTheNearestOne) {
  EXPECT_THAT(error_of(R"("gian": 2)"), AllOf(HasSubstr("/instances/a/parameters/gian"), HasSubstr("'gain'")));
}

TEST(StartValues, TypesAreChecked) {
  EXPECT_THAT(error_of(R"("gain": "2")"), AllOf(HasSubstr("'gain' is of type Real"), HasSubstr("\"2\"")));
  EXPECT_THAT(error_of(R"("gain": true)"), HasSubstr("takes a finite number"));
  EXPECT_THAT(error_of(R"("integer_in": 1.5)"), HasSubstr("takes a whole number"));
  EXPECT_THAT(error_of(R"("integer_in": 3000000000)"), HasSubstr("a whole number from -2147483648 to 2147483647"));
  EXPECT_THAT(error_of(R"("boolean_in": 1)"), HasSubstr("takes true or false"));
  EXPECT_THAT(error_of(R"("string_in": 1)"), HasSubstr("takes a text"));
}

TEST(StartValues, EnumerationsAreGivenByItemOrNumber) {
  EXPECT_THAT(error_of(R"("mode_in": "bth")"),
              AllOf(HasSubstr("not an item of the enumeration 'Mode'"), HasSubstr("'both'")));
  EXPECT_THAT(error_of(R"("mode_in": 3)"), HasSubstr("has no item with the number 3"));
  for (const char* value : {"\"both\"", "7"}) {
    const test::TestRun run(two_probes(fmt::format(R"("mode_in": {})", value), ""));
    EXPECT_EQ(std::get<std::int64_t>(run.system.instances[0].starts.at(0).value), 7);
  }
}

TEST(StartValues, DeclaredLimitsHold) {
  EXPECT_THAT(error_of(R"("gain": 11)"),
              AllOf(HasSubstr("11 is above the maximum 10"), HasSubstr("/instances/a/parameters/gain")));
  EXPECT_THAT(error_of(R"("gain": -10.5)"), HasSubstr("-10.5 is below the minimum -10"));
}

TEST(StartValues, CalculatedOutputsCannotBeSet) {
  EXPECT_THAT(error_of(R"("real_out": 1)"), AllOf(HasSubstr("'a.real_out' cannot be set"), HasSubstr("calculated")));
}

TEST(StartValues, ExactOutputsCanBeSet) {
  test::TestRun run(two_probes(R"("integral": 5, "real_in": 2)", ""));
  run.to_end();
  EXPECT_EQ(run.column("a.integral").front(), 5);
  EXPECT_NEAR(run.column("a.integral").back(), 5 + 2 * 1.2, 1e-12);  // tolerance for twelve roundings
}

TEST(StartValues, TheCommandLineWinsOverTheConfig) {
  const modeldesc::TemporaryFolder folder("mebots-test");
  test::write_file(folder.path() / "x.json",
                   test::with_probe(two_probes(R"("gain": 2, "mode_in": 0, "boolean_in": false)", "")));
  auto description = read_config(folder.path() / "x.json");
  for (const char* set :
       {"a.gain=3e0", "a.mode_in=both", "a.boolean_in=true", "a.string_in=hello there", "a.integer_in=-4"}) {
    test::apply_set(description, set);
  }
  FmuLibrary library;
  const auto system = resolve(description, library);
  std::vector<modeldesc::Value> values;
  for (const auto& start : system.instances[0].starts) values.push_back(start.value);
  EXPECT_THAT(values, testing::ElementsAre(modeldesc::Value(3.0), modeldesc::Value(-4), modeldesc::Value(7),
                                           modeldesc::Value(true), modeldesc::Value(std::string("hello there"))));
}

TEST(StartValues, TextOnTheCommandLineIsCheckedToo) {
  const modeldesc::TemporaryFolder folder("mebots-test");
  test::write_file(folder.path() / "x.json", test::with_probe(two_probes("", "")));
  const auto setting = [&](const char* text) {
    auto description = read_config(folder.path() / "x.json");
    test::apply_set(description, text);
    FmuLibrary library;
    return test::input_error([&] { resolve(description, library); });
  };
  EXPECT_THAT(setting("a.gain=much"), AllOf(HasSubstr("--set a.gain=much"), HasSubstr("'much'")));
  EXPECT_THAT(setting("a.gain=nan"), HasSubstr("finite"));
  EXPECT_THAT(setting("a.gain=2 "), HasSubstr("finite number"));
  EXPECT_THAT(setting("a.integer_in=0x10"), HasSubstr("whole number"));
  EXPECT_THAT(setting("a.boolean_in=yes"), HasSubstr("true or false"));
  EXPECT_THAT(setting("a.fault_tiem=1"), HasSubstr("'fault_time'"));
}

TEST(OpenInputs, AreNoticedOnceUnlessGivenAValue) {
  const test::TestRun run(two_probes(
      R"("real_in": 1)", R"({"from": "a.mode_out", "to": "b.mode_in"}, {"from": "a.buffer", "to": "b.taken"})"));
  EXPECT_THAT(
      run.system.notices,
      testing::ElementsAre(
          AllOf(HasSubstr("a: not connected"), HasSubstr(": integer_in, mode_in, taken, boolean_in, string_in")),
          AllOf(HasSubstr("b: not connected"), HasSubstr(": real_in, integer_in, boolean_in, string_in"))));
}

TEST(Record, APatternThatFitsNothingIsRefused) {
  EXPECT_THAT(
      test::input_error([] {
        test::TestRun run(
            R"({"step": 0.1, "stop_time": 1, "instances": {"a": {"fmu": "PROBE"}}, "connections": [], "record": ["a.real_*", "a.stepps"]})");
      }),
      AllOf(HasSubstr("/record/1"), HasSubstr("'a.steps'")));
}

TEST(Conditions, VariableAndValueAreChecked) {
  const auto stopping = [](const std::string& condition) {
    return test::input_error([&] {
      test::TestRun run(
          R"({"step": 0.1, "stop_time": 1, "instances": {"a": {"fmu": "PROBE"}}, "connections": [], "stop_when": [)" +
          condition + "]}");
    });
  };
  EXPECT_THAT(stopping(R"({"variable": "a.stepps", "above": 3})"),
              AllOf(HasSubstr("/stop_when/0/variable"), HasSubstr("'steps'")));
  EXPECT_THAT(stopping(R"({"variable": "a.boolean_out", "equals": 3})"), HasSubstr("true or false"));
  EXPECT_THAT(stopping(R"({"variable": "a.boolean_out", "above": 0})"), HasSubstr("use 'equals'"));
}

}  // namespace
}  // namespace mebots::master
