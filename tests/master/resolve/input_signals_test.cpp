// SPDX-License-Identifier: Apache-2.0
// Tests inputs from CSV files: the values that an FMU receives at each time, and invalid files.
#include "io/config/load_system.hpp"
#include "model/signal.hpp"
#include "run/run.hpp"
#include "test_system.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <random>

namespace mebots::master {
namespace {

using test::TestRun;
using testing::AllOf;
using testing::Contains;
using testing::DoubleNear;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

using MasterRun = Run;  // GoogleTest's class has a member Run

class Files {
 public:
  Files() = default;
  explicit Files(const std::string& text) { put("in.csv", text); }

  std::string put(const std::string& name, const std::string& text) const {
    test::write_file(folder_.path() / name, text);
    return path(name);
  }
  std::string path(const std::string& name = "in.csv") const { return (folder_.path() / name).string(); }

 private:
  modeldesc::TemporaryFolder folder_{"mebots-test"};
};

/// Returns a config with one instance `a` of the probe FMU and its inputs. `inputs` are further members of the section
/// "inputs".
std::string probe_with(const Files& files, const std::string& inputs, const std::string& more = "",
                       const std::string& fmu = "PROBE") {
  return fmt::format(R"({{"step": 0.1, "stop_time": 1, "instances": {{"a": {{"fmu": "{}"}}}}, "connections": [],
                         "inputs": {{"file": "{}"{}}},
                         "record": {{"variables": ["a.*", "a.real_in", "a.integer_in", "a.mode_in", "a.boolean_in",
                                                   "a.string_in"], "texts": true}}{}}})",
                     fmu, files.path(), inputs, more);
}

std::string to(const std::string& mapping) {
  return R"(, "to": {)" + mapping + "}";
}

const std::string kToReal = to(R"("u": "a.real_in")");

std::vector<double> real_in(const std::string& csv, const std::string& more = "") {
  const Files files(csv);
  return TestRun(probe_with(files, kToReal, more)).to_end().column("a.real_in");
}

/// Returns code and message of the InputError for a config.
std::pair<ErrorCode, std::string> refusal(const std::string& config) {
  try {
    TestRun run(config);
  } catch (const InputError& error) {
    return {error.code(), error.what()};
  }
  return {ErrorCode::unspecified, ""};
}

std::pair<ErrorCode, std::string> refusal_of_file(const std::string& csv, const std::string& inputs = kToReal) {
  const Files files(csv);
  return refusal(probe_with(files, inputs));
}

// The value at a point is the input of the step that ends there. The value at 0 s is that of the initialisation.

TEST(InputSignals, ARealIsInterpolatedAtTheStartOfEachStep) {
  const Files files("time,u\n0,0\n1,10\n");
  TestRun run(probe_with(files, kToReal));
  run.to_end();
  const auto values = run.column("a.real_in");
  for (std::size_t k = 1; k < values.size(); ++k) EXPECT_DOUBLE_EQ(values[k], static_cast<double>(k) - 1) << k;
  EXPECT_EQ(values[0], 0);
  EXPECT_DOUBLE_EQ(run.column("a.integral").back(), 4.5) << "0.1 (0 + 1 + ... + 9), the left Riemann sum";
}

TEST(InputSignals, AnFmuThatInterpolatesGetsTheExactIntegralOfARamp) {
  const Files files("time,u\n0,0\n1,10\n");
  TestRun run(
      fmt::format(R"({{"step": 0.1, "stop_time": 1, "instances": {{"c": {{"fmu": "COUPLING"}}}}, "connections": [],
                             "inputs": {{"file": "{}", "to": {{"u": "c.ramp_in"}}}}, "record": ["c.ramp_area"]}})",
                  files.path()));
  EXPECT_NEAR(run.to_end().column("c.ramp_area").back(), 5, 1e-14);  // tolerance for ten roundings
}

TEST(InputSignals, SlopesEndBeforeAJumpAndNeverOvershoot) {
  const Files files("time,u\n0,0\n0.5,0\n0.5,1\n1,1\n");
  TestRun run(
      fmt::format(R"({{"step": 0.1, "stop_time": 1, "instances": {{"c": {{"fmu": "COUPLING"}}}}, "connections": [],
                             "inputs": {{"file": "{}", "to": {{"u": "c.ramp_in"}}}}, "record": ["c.ramp_area"]}})",
                  files.path()));
  const auto area = run.to_end().column("c.ramp_area");
  EXPECT_EQ(area[5], 0);
  EXPECT_NEAR(area.back(), 0.5, 1e-15);
}

TEST(InputSignals, AKinkBetweenTwoPointsGivesTheLineBetweenTheValuesAtThem) {
  const Files files("time,u\n0,0\n0.25,1\n1,1\n");  // 0.8 at 0.2 s and 1 at 0.3 s; with the slope 4, it would be 1.2
  TestRun run(
      fmt::format(R"({{"step": 0.1, "stop_time": 0.3, "instances": {{"c": {{"fmu": "COUPLING"}}}}, "connections": [],
                             "inputs": {{"file": "{}", "to": {{"u": "c.ramp_in"}}}}, "record": ["c.ramp_area"]}})",
                  files.path()));
  EXPECT_NEAR(run.to_end().column("c.ramp_area").back(), 0.02 + 0.06 + 0.09, 1e-15);
}

TEST(InputSignals, TwoRowsOfOneTimeAreAJump) {
  const auto values = real_in("time,u\n0,2\n0.5,2\n0.5,4\n1,4\n");
  EXPECT_THAT(values, ElementsAre(2, 2, 2, 2, 2, 2, 4, 4, 4, 4, 4)) << "the step from 0.5 s has the second value";
}

TEST(InputSignals, InitialisationGetsTheValueBeforeAJumpAndTheFirstStepTheValueAfterIt) {
  EXPECT_THAT(real_in("time,u\n0,1\n0,3\n1,3\n"), ElementsAre(1, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3));
}

TEST(InputSignals, TheLastRowMayBeAJump) {
  EXPECT_THAT(real_in("time,u\n0,1\n0.5,1\n0.5,7\n"), ElementsAre(1, 1, 1, 1, 1, 1, 7, 7, 7, 7, 7));
}

TEST(InputSignals, ADirectOutputShowsTheFirstValueAfterInitialisation) {
  const Files files("time,u\n0,3\n1,3\n");
  EXPECT_THAT(TestRun(probe_with(files, kToReal)).to_end().column("a.real_out"), Each(3));
}

TEST(InputSignals, DiscreteVariablesAreHeld) {
  const Files files("time,i,b,m\n0,1,0,off\n0.3,2.0,TRUE,both\n0.7,5,false,1\n1,9,1,off\n");
  TestRun run(probe_with(files, to(R"("i": "a.integer_in", "b": "a.boolean_in", "m": "a.mode_in")")));
  run.to_end();
  EXPECT_THAT(run.column("a.integer_in"), ElementsAre(1, 1, 1, 1, 2, 2, 2, 2, 5, 5, 5));
  EXPECT_THAT(run.column("a.boolean_in"), ElementsAre(0, 0, 0, 0, 1, 1, 1, 1, 0, 0, 0));
  EXPECT_THAT(run.column("a.mode_in"), ElementsAre(0, 0, 0, 0, 7, 7, 7, 7, 1, 1, 1));
}

TEST(InputSignals, ADiscreteRealIsHeld) {
  const test::ChangedFmu fmu("probe", R"(name="real_in" valueReference="0" causality="input")",
                             R"(name="real_in" valueReference="0" causality="input" variability="discrete")");
  const Files files("time,u\n0,0\n0.5,10\n1,20\n");
  TestRun run(probe_with(files, kToReal, "", fmu.path().string()));
  EXPECT_THAT(run.to_end().column("a.real_in"), ElementsAre(0, 0, 0, 0, 0, 0, 10, 10, 10, 10, 10));
}

TEST(InputSignals, TextsAreHeld) {
  const Files files("time,s\n0,one\n0.5,\"two, quoted\"\n");
  TestRun run(probe_with(files, to(R"("s": "a.string_in")")));
  run.to_end();
  EXPECT_THAT(run.csv(), AllOf(HasSubstr(",one"), HasSubstr("\"two, quoted\"")));
}

TEST(InputSignals, RowsAndPointsMeetThoughTheirDoublesDiffer) {
  // 0.1 + 0.2 is 0.30000000000000004.
  EXPECT_THAT(real_in("time,u\n0,0\n0.30000000000000004,0\n0.30000000000000004,1\n1,1\n"),
              ElementsAre(0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1));
}

TEST(InputSignals, TimesAreThoseOfTheRun) {
  const Files files("time,u\n0,0\n4,8\n");
  TestRun run(fmt::format(R"({{"step": 0.5, "start_time": 2, "stop_time": 3.5, "instances": {{"a": {{"fmu": "PROBE"}}}},
                             "connections": [], "inputs": {{"file": "{}", "to": {{"u": "a.real_in"}}}},
                             "record": ["a.real_in"]}})",
                          files.path()));
  EXPECT_THAT(run.to_end().column("a.real_in"), ElementsAre(4, 4, 5, 6));
}

TEST(InputSignals, AnInstanceWithALongerStepGetsValuesAtItsOwnPoints) {
  const Files files("time,u\n0,0\n1,10\n");
  TestRun run(fmt::format(R"({{"step": 0.1, "stop_time": 0.6, "instances": {{"a": {{"fmu": "PROBE", "step": 0.3}},
                             "b": {{"fmu": "PROBE"}}}}, "connections": [],
                             "inputs": {{"file": "{}", "to": {{"u": ["a.real_in", "b.real_in"]}}}},
                             "record": ["a.real_in", "b.integral"]}})",
                          files.path()));
  run.to_end();
  EXPECT_DOUBLE_EQ(run.column("a.real_in").back(), 3);
  EXPECT_DOUBLE_EQ(run.column("b.integral").back(), 1.5);
}

TEST(InputSignals, UnitsAreConverted) {
  const auto first = [](const std::string& title, const std::string& inputs = kToReal) {
    const Files files(fmt::format("time,{}\n0,2\n1,2\n", title));
    return TestRun(probe_with(files, inputs)).to_end().column("a.real_in").back();
  };
  EXPECT_EQ(first("u [km]"), 2000);
  EXPECT_EQ(first("u [metre]"), 2) << "a unit of the FMU's own";
  EXPECT_EQ(first("u [m]"), 2);
  EXPECT_EQ(first("u [-]"), 2);
  EXPECT_EQ(first("u", to(R"("u": {"variable": "a.real_in", "unit": "mm"})")), 0.002);
  EXPECT_EQ(first("u [km]", to(R"("u [km]": "a.real_in")")), 2000) << "the whole title names the column, too";
}

TEST(InputSignals, DisplayUnitsOfTheFmuAndOffsetsAreConverted) {
  const std::string unit = R"(<Unit name="m"><BaseUnit m="1"/></Unit>)";
  const test::ChangedFmu inches("probe", unit,
                                R"(<Unit name="m"><BaseUnit m="1"/><DisplayUnit name="inch" factor="40"/></Unit>)");
  const Files in_inches("time,u [inch]\n0,80\n");
  EXPECT_EQ(TestRun(probe_with(in_inches, kToReal, "", inches.path().string())).to_end().column("a.real_in").back(), 2);
  const test::ChangedFmu kelvin("probe", unit, R"(<Unit name="m"><BaseUnit K="1"/></Unit>)");
  const Files in_celsius("time,u [degC]\n0,20\n");
  EXPECT_DOUBLE_EQ(
      TestRun(probe_with(in_celsius, kToReal, "", kelvin.path().string())).to_end().column("a.real_in").back(), 293.15);
}

TEST(InputSignals, TheTimesHaveAUnitToo) {
  EXPECT_THAT(real_in("T [ms],u\n0,1\n500,1\n500,2\n"), ElementsAre(1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2));
  const Files files("u,stamp\n1,0\n2,1\n");
  EXPECT_DOUBLE_EQ(TestRun(probe_with(files, kToReal + R"(, "time": "stamp")")).to_end().column("a.real_in").back(),
                   1.9);
}

TEST(InputSignals, UnitsThatDoNotFitAreRefused) {
  using enum ErrorCode;
  EXPECT_THAT(refusal_of_file("time,u [kg]\n0,1\n"), testing::Pair(wrong_unit, HasSubstr("[kg] is kg and [m] is m")));
  EXPECT_THAT(refusal_of_file("time,u [mters]\n0,1\n"), testing::Pair(wrong_unit, HasSubstr("in.csv: 'u'")));
  EXPECT_EQ(refusal_of_file("time [m],u\n0,1\n").first, wrong_unit);
  EXPECT_EQ(refusal_of_file("time,u [km]\n0,1\n", to(R"("u": {"variable": "a.real_in", "unit": "m"})")).first,
            wrong_unit);
  EXPECT_EQ(refusal_of_file("time,u [m]\n0,1\n", to(R"("u": "a.integer_in")")).first, wrong_unit);
}

TEST(InputSignals, OutsideTheRowsTheNearestValueHoldsOrTheRunIsRefused) {
  const std::string csv = "time,u\n0.2,1\n0.5,4\n";
  const auto values = real_in(csv);
  EXPECT_THAT(std::vector(values.begin(), values.begin() + 4), ElementsAre(1, 1, 1, 1));
  EXPECT_EQ(values.back(), 4);
  const Files files(csv);
  EXPECT_THAT(TestRun(probe_with(files, kToReal)).system.notices,
              AllOf(Contains(HasSubstr("the first row is at 0.2 s")), Contains(HasSubstr("the last row is at 0.5 s"))));
  EXPECT_THAT(refusal_of_file(csv, kToReal + R"(, "before": "error")"),
              testing::Pair(ErrorCode::invalid_value, HasSubstr("'a.real_in' needs a value at 0 s")));
  EXPECT_THAT(refusal_of_file(csv, kToReal + R"(, "after": "error")"),
              testing::Pair(ErrorCode::invalid_value, HasSubstr("needs a value at 0.9 s")));
  EXPECT_EQ(refusal_of_file("time,u\n0,1\n0.9,1\n", kToReal + R"(, "after": "error", "before": "error")").second, "")
      << "the last step begins at 0.9 s";
}

TEST(InputSignals, ReportsSignalPointsBetweenCommunicationPoints) {
  const auto notices = [](const std::string& csv, const std::string& inputs = kToReal) {
    const Files files(csv);
    return TestRun(probe_with(files, inputs)).system.notices;
  };
  EXPECT_THAT(notices("time,u\n0,0\n0.25,0\n0.25,1\n1,1\n"),
              Contains(AllOf(HasSubstr("1 jumps or changes"), HasSubstr("the first at 0.25 s"))));
  EXPECT_THAT(notices("time,u\n0,0\n0.3,0\n0.3,1\n1,1\n"), Each(Not(HasSubstr("jumps"))));
  EXPECT_THAT(notices("time,i\n0,0\n0.25,0\n0.35,1\n1,1\n", to(R"("i": "a.integer_in")")),
              Contains(AllOf(HasSubstr("1 jumps or changes"), HasSubstr("the first at 0.35 s"))));
  EXPECT_THAT(notices("time,u\n0,0\n0.05,5\n0.1,0\n1,0\n"), Contains(HasSubstr("1 of 2 rows are skipped")));
}

TEST(InputSignals, BadCellsAreRefusedWithTheirPlace) {
  using enum ErrorCode;
  const auto refused = [](const std::string& csv, const std::string& variable) {
    return refusal_of_file(csv, to(fmt::format(R"("u": "a.{}")", variable)));
  };
  EXPECT_THAT(refused("time,u\n0,1\n0.5,\n", "real_in"),
              testing::Pair(wrong_type, HasSubstr("in.csv:3: column 2 ('u')")));
  EXPECT_THAT(refused("time,u\n0,one\n", "real_in"), testing::Pair(wrong_type, HasSubstr("'one' is not a number")));
  EXPECT_EQ(refused("time,u\n0,nan\n", "real_in").first, not_finite);
  EXPECT_EQ(refused("time,u\nnan,1\n", "real_in").first, not_finite);
  EXPECT_EQ(refused("time,u\n0,1.5\n", "integer_in").first, wrong_type);
  EXPECT_EQ(refused("time,u\n0,3000000000\n", "integer_in").first, wrong_type);
  EXPECT_EQ(refused("time,u\n0,2\n", "boolean_in").first, wrong_type);
  EXPECT_EQ(refused("time,u\n0,\n", "boolean_in").first, wrong_type);
  EXPECT_THAT(refused("time,u\n0,bth\n", "mode_in"), testing::Pair(unknown_name, HasSubstr("'both'")));
  EXPECT_EQ(refused("time,u\n0,5\n", "mode_in").first, unknown_name);
  EXPECT_THAT(refused("time;u\n0;0,5\n", "real_in"), testing::Pair(syntax_error, HasSubstr("semicolons")));
  EXPECT_EQ(refused("time,u\n", "real_in").first, syntax_error);
  EXPECT_EQ(refused("", "real_in").first, syntax_error);
}

TEST(InputSignals, ValuesOutsideTheLimitsOfTheVariableAreRefused) {
  const test::ChangedFmu fmu("probe", R"(<Real unit="m" start="0"/>)",
                             R"(<Real unit="m" start="0" min="-1" max="2"/>)");
  const Files files("time,u\n0,2\n0.5,2.5\n");
  EXPECT_THAT(refusal(probe_with(files, kToReal, "", fmu.path().string())),
              testing::Pair(ErrorCode::value_out_of_range, AllOf(HasSubstr("in.csv:3"), HasSubstr("maximum 2"))));
}

TEST(InputSignals, TimesThatDoNotGoForwardAreRefused) {
  using enum ErrorCode;
  EXPECT_THAT(
      refusal_of_file("time,u\n0,1\n0.5,1\n0.3,1\n"),
      testing::Pair(invalid_value, AllOf(HasSubstr("in.csv:4: column 1 ('time')"), HasSubstr("0.3 s follows 0.5 s"))));
  EXPECT_THAT(refusal_of_file("time,u\n0,1\n0,2\n0,3\n"), testing::Pair(invalid_value, HasSubstr("in.csv:4")));
  EXPECT_EQ(refusal_of_file("time,u\n1e12,1\n").first, value_out_of_range);
}

TEST(InputSignals, ColumnsThatAreMissingAreRefused) {
  using enum ErrorCode;
  EXPECT_THAT(refusal_of_file("time,uu\n0,1\n"), testing::Pair(unknown_name, HasSubstr("Did you mean 'uu'")));
  EXPECT_THAT(refusal_of_file("stamp,u\n0,1\n"), testing::Pair(missing_key, HasSubstr("column of times")));
  EXPECT_EQ(refusal_of_file("time,u\n0,1\n", kToReal + R"(, "time": "stamp")").first, unknown_name);
  EXPECT_EQ(refusal_of_file(",time,u\n0,0,1\n").first, syntax_error) << "an index without a name";
}

TEST(InputSignals, AnInputHasOneSource) {
  using enum ErrorCode;
  const Files files("time,u\n0,1\n");
  const auto config = [&](const std::string& rest, const std::string& to) {
    return fmt::format(R"({{"step": 0.1, "stop_time": 1, "instances": {{"a": {{"fmu": "PROBE"}}, "b": {{"fmu": "PROBE",
                           "parameters": {{"gain": 2{}}}}}}}, "connections": [{{"from": "a.real_out", "to": "b.real_in"}}],
                           "inputs": {{"file": "{}", "to": {{"u": "{}"}}}}}})",
                       rest, files.path(), to);
  };
  EXPECT_THAT(refusal(config("", "b.real_in")), testing::Pair(invalid_connection, HasSubstr("a.real_out")));
  EXPECT_EQ(refusal(config(R"(, "integer_in": 3)", "b.integer_in")).first, invalid_value);
  EXPECT_EQ(refusal(config("", "b.gain")).first, invalid_value);
  EXPECT_EQ(refusal(config("", "b.real_out")).first, invalid_value);
  EXPECT_EQ(refusal(config("", "b.nothing")).first, unknown_name);
  EXPECT_EQ(refusal(config("", "b.taken.size")).first, invalid_value);
  EXPECT_EQ(refusal_of_file("time,u,v\n0,1,2\n", to(R"("u": "a.real_in", "v": "a.real_in")")).first,
            invalid_connection);
}

TEST(InputSignals, NoNoticeCallsAnInputWithASignalOpen) {
  const Files files("time,u\n0,1\n1,1\n");
  for (const auto& notice : TestRun(probe_with(files, kToReal)).system.notices) {
    EXPECT_THAT(notice, Not(AllOf(HasSubstr("not connected"), HasSubstr("real_in"))));
  }
}

TEST(InputSignals, ScenarioEntriesActOnTheSignal) {
  EXPECT_THAT(real_in("time,u\n0,1\n1,1\n",
                      R"(, "scenario": [{"variable": "a.real_in", "offset": 2, "from": 0.5, "until": 0.7}])"),
              ElementsAre(1, 1, 1, 1, 1, 1, 3, 3, 1, 1, 1));
}

TEST(InputSignals, AScenarioGivesAConnectedInputOrAnOutputASignalForSomeTime) {
  const Files files("time,u [km]\n0,0\n1,0.01\n");
  const auto run = [&](const std::string& variable) {
    return fmt::format(
        R"({{"step": 0.1, "stop_time": 1, "instances": {{"a": {{"fmu": "PROBE"}}, "b": {{"fmu": "PROBE"}}}},
                           "connections": [{{"from": "a.real_out", "to": "b.real_in"}}], "record": ["a.real_out", "b.real_in"],
                           "scenario": [{{"variable": "{}", "signal": "u", "file": "{}", "from": 0.3, "until": 0.6}}]}})",
        variable, files.path());
  };
  TestRun input(run("b.real_in"));
  input.to_end();
  EXPECT_THAT(input.column("b.real_in"),
              ElementsAre(0, 0, 0, 0, DoubleNear(3, 1e-14), DoubleNear(4, 1e-14), DoubleNear(5, 1e-14), 0, 0, 0, 0));
  TestRun output(run("a.real_out"));
  output.to_end();
  EXPECT_THAT(output.column("a.real_out"),
              ElementsAre(0, 0, 0, DoubleNear(3, 1e-14), DoubleNear(4, 1e-14), DoubleNear(5, 1e-14), 0, 0, 0, 0, 0));
}

TEST(InputSignals, AnIsolatedInstanceGetsTheSame) {
  const Files files("time,u,i,s\n0,0,1,x\n0.5,3,2,y\n0.5,4,3,z\n1,9,4,x\n");
  const auto mapping = to(R"("u": "a.real_in", "i": "a.integer_in", "s": "a.string_in")");
  const auto shared = TestRun(probe_with(files, mapping)).to_end().csv();
  auto own = probe_with(files, mapping);
  own.replace(own.find("\"fmu\""), 0, "\"process\": \"own\", ");
  EXPECT_EQ(TestRun(own).to_end().csv(), shared);
}

TEST(InputSignals, ARunFromASavedStateContinuesWithTheSameBits) {
  const Files files("time,u\n0,0\n0.33,3\n0.33,-1\n0.71,4\n1,9\n");
  auto text = test::with_probe(probe_with(files, kToReal));
  const std::string probe = "probe.fmu";  // cannot start from a saved state, because it changes timers
  text.replace(text.find(probe), probe.size(), "steady.fmu");
  const auto config = files.put("c.json", text);
  const auto columns = [](MasterRun& run) {
    run.run();
    return run.memory().find("a.integral")->values;
  };
  MasterRun straight(config);
  MasterRun first(config);
  first.run_until(400'000'000);
  const auto state = first.save_state();
  MasterRun second(config);
  second.start_from(state);
  EXPECT_EQ(columns(second), columns(straight));
}

TEST(InputSignals, FilesAreInputsOfTheRun) {
  const Files files("time,u\n0,0\n1,1\n");
  const auto config = files.put("c.json", test::with_probe(probe_with(files, kToReal)));
  const auto hash = [&] {
    const auto system = read_config(config);
    return hash_inputs(system, {});
  };
  const auto before = hash();
  ASSERT_EQ(before.files.size(), 1);
  files.put("in.csv", "time,u\n0,0\n1,2\n");
  EXPECT_NE(hash().all, before.all);
}

TEST(InputSignals, ASystemThatIsConvertedKeepsItsFiles) {
  const Files files("time,u\n0,0\n1,1\n");
  auto config = probe_with(files, kToReal);
  config.replace(config.find(files.path()), files.path().size(), "in.csv");  // relative to the config
  const std::filesystem::path json = files.put("c.json", test::with_probe(config));
  const auto folder = json.parent_path();
  std::filesystem::create_directory(folder / "sub");
  EXPECT_EQ(test::run_program({"convert", "c.json", "sub/c.ssp"}, folder).code, 0);
  EXPECT_EQ(test::run_program({"run", "c.json", "--out", "json"}, folder).code, 0);
  EXPECT_EQ(test::run_program({"run", "sub/c.ssp", "--out", "ssp"}, folder).code, 0);
  EXPECT_EQ(test::read_file(folder / "json" / "results.csv"), test::read_file(folder / "ssp" / "results.csv"));
}

TEST(InputSignals, AnInputHasNoSecondSource) {
  const Files files("time,u\n0,0\n1,1\n");
  MasterRun run(files.put("c.json", test::with_probe(probe_with(files, kToReal))));
  run.start();
  EXPECT_THAT(writable_variables(run.resolved()).dump(), AllOf(Not(HasSubstr("a.real_in")), HasSubstr("a.integer_in")));
  EXPECT_THAT(test::input_error([&] { write_variable(run, "a.real_in", 1, "write"); }), HasSubstr("in.csv"));
}

TEST(InputSignals, AColumnNamesItsInputWhereNothingIsMapped) {
  const Files files("time [s],a.real_in [km],a.integer_in\n0,1,3\n");
  TestRun run(probe_with(files, ""));
  run.to_end();
  EXPECT_EQ(run.column("a.real_in").back(), 1000);
  EXPECT_EQ(run.column("a.integer_in").back(), 3);
  EXPECT_THAT(refusal_of_file("time,a.rael_in\n0,1\n", ""),
              testing::Pair(ErrorCode::unknown_name, HasSubstr("'real_in'")));
  EXPECT_EQ(refusal_of_file("time,real_in\n0,1\n", "").first, ErrorCode::syntax_error);
}

TEST(InputSignals, AConfigIsReadWithTheFileOfSignalsThere) {
  EXPECT_THAT(refusal(R"({"step": 0.1, "stop_time": 1, "instances": {"a": {"fmu": "PROBE"}}, "connections": [],
                         "inputs": {"file": "missing.csv"}})"),
              testing::Pair(ErrorCode::file_not_found, HasSubstr("/inputs/file")));
}

TEST(Signal, FindsTheRowOfAnyTimeFromAnyStart) {
  std::mt19937_64 random(7);
  std::vector<double> times = {-1};
  while (times.size() < 400)
    times.push_back(times.back() +
                    (random() % 3 == 0 && times.size() > 1 && times.back() != times[times.size() - 2] ? 0.0 : 0.25));
  const SignalTimes signal(times);
  for (int i = 0; i < 2000; ++i) {
    const auto time_ns = static_cast<std::int64_t>(random() % 500) * 125'000'000 - 2'000'000'000;
    auto last = SignalTimes::kNone;
    auto first = SignalTimes::kNone;
    for (std::size_t row = 0; row < times.size() && signal.ns(row) <= time_ns; ++row) {
      if (last == SignalTimes::kNone || signal.ns(row) != signal.ns(last)) first = row;
      last = row;
    }
    if (first != last && signal.ns(last) != time_ns) first = last;
    const auto near = random() % 450;
    EXPECT_EQ(signal.row_at(time_ns, SignalSide::after, near), last);
    EXPECT_EQ(signal.row_at(time_ns, SignalSide::before, near), first);
  }
}

}  // namespace
}  // namespace mebots::master
