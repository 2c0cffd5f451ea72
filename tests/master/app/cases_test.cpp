// SPDX-License-Identifier: Apache-2.0
// Tests `mebots test`, which compares an FMU with expected outputs in CSV files.
#include "cases/run_case.hpp"
#include "test_system.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

namespace mebots::master {
namespace {

using cases::Verdict;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

/// A folder with an FMU, cases and their CSV files.
class CaseFolder {
 public:
  CaseFolder() { std::filesystem::copy(PROBE_FMU, path() / "thing.fmu"); }

  std::filesystem::path path() const { return folder_.path(); }
  void write(const std::string& name, const std::string& text) const { test::write_file(path() / name, text); }

  /// Runs a case with the expected outputs `expected`. `keys` are further members of the case.
  cases::CaseResult run(const std::string& expected, const std::string& keys = "", bool isolate = false) const {
    write("out.csv", expected);
    write("cases.json", fmt::format(R"({{"cases": {{"one": {{"expected": "out.csv"{}}}}}}})", keys));
    const auto file = cases::read_cases(path() / "cases.json");
    return cases::run_case(path() / "thing.fmu", file.cases.at(0), {.isolate = isolate});
  }

 private:
  modeldesc::TemporaryFolder folder_{"mebots-test"};
};

// The probe computes real_out = gain * real_in + offset, and adds h * real_in to `integral`, with the step 0.1 s.

TEST(Cases, OutputsThatAreAsExpectedPass) {
  const CaseFolder folder;
  folder.write("in.csv", "time,real_in\n0,1\n1,11\n");
  const auto result = folder.run("time [s],real_out [metre],thing.steps\n0,2,0\n0.5,10,5\n1,20,10\n",
                                 R"(, "inputs": "in.csv", "parameters": {"gain": 2})");
  EXPECT_EQ(result.verdict, Verdict::passed) << result.text();
  EXPECT_EQ(result.text(), "3 rows of 2 variables");
}

TEST(Cases, TheFirstDivergenceIsReported) {
  const CaseFolder folder;
  folder.write("in.csv", "time,real_in\n0,1\n");
  const auto result =
      folder.run("time,integral,steps,real_out\n0,0,0,1\n0.5,0.5,5,1.25\n1,1.5,11,1\n", R"(, "inputs": ["in.csv"])");
  EXPECT_EQ(result.verdict, Verdict::failed);
  ASSERT_TRUE(result.first);
  EXPECT_EQ(result.first->variable, "real_out");
  EXPECT_EQ(result.first->time_s, 0.5);
  EXPECT_EQ(result.first->difference, -0.25);
  EXPECT_THAT(result.others, ElementsAre("integral", "steps"));
  EXPECT_EQ(result.text(),
            "at 0.5 s real_out is 1, expected 1.25 (difference -0.25, tolerance 1.251e-06); 2 more diverge: integral, "
            "steps");
}

TEST(Cases, TolerancesAreThoseOfTheVariable) {
  const CaseFolder folder;
  const auto verdict = [&](const std::string& tolerance) {
    return folder
        .run("time,real_out,integral\n1,1.1,0.01\n", R"(, "parameters": {"real_in": 0, "offset": 1})" + tolerance)
        .verdict;
  };
  EXPECT_EQ(verdict(""), Verdict::failed);
  EXPECT_EQ(verdict(R"(, "tolerance": {"absolute": 0.1, "relative": 0.01})"), Verdict::passed);
  EXPECT_EQ(verdict(R"(, "tolerance": {"absolute": 0.1, "relative": 0})"), Verdict::failed) << "1.1 - 1 is above 0.1";
  EXPECT_EQ(verdict(R"(, "tolerances": {"real_*": {"relative": 0.1}, "integral": {"absolute": 0.01}})"),
            Verdict::passed);
  EXPECT_EQ(verdict(R"(, "tolerances": {"*": {"absolute": 1}, "integral": {"absolute": 0.001}})"), Verdict::failed)
      << "the last that fits applies";
}

TEST(Cases, TextsIntegersAndBooleansAreComparedExactly) {
  const CaseFolder folder;
  const std::string keys =
      R"(, "parameters": {"string_in": "hello", "boolean_in": true}, "tolerance": {"absolute": 9})";
  EXPECT_EQ(folder.run("time,string_out,boolean_out,integer_out\n0,hello!,false,1\n1,hello!,0,1\n", keys).verdict,
            Verdict::passed);
  EXPECT_THAT(folder.run("time,string_out\n0,hello!\n0.5,bye!\n", keys).text(),
              HasSubstr("at 0.5 s string_out is 'hello!', expected 'bye!'"));
  EXPECT_THAT(folder.run("time,integer_out\n0.3,2\n", keys).text(), HasSubstr("integer_out is 1, expected 2"));
}

TEST(Cases, RowsBetweenCommunicationPointsAreInterpolatedAndOneOfTwoAtAJumpSuffices) {
  const CaseFolder folder;
  folder.write("in.csv", "time,real_in\n0,0\n0.5,0\n0.5,8\n1,8\n");
  const auto run = [&](const std::string& expected) { return folder.run(expected, R"(, "inputs": "in.csv")"); };
  EXPECT_EQ(run("time,integral,steps\n0.55,0.4,5\n0.98,3.84,9\n").verdict, Verdict::passed);
  EXPECT_EQ(run("time,real_out\n0.5,0\n0.5,8\n0.6,8\n").verdict, Verdict::passed);
  EXPECT_EQ(run("time,real_out\n0.6,0\n0.6,8\n").verdict, Verdict::passed);
  EXPECT_EQ(run("time,real_out\n0.6,0\n0.6,7\n").verdict, Verdict::failed);
}

TEST(Cases, TheRunEndsAtThePointAfterTheLastRow) {
  const CaseFolder folder;
  EXPECT_EQ(folder.run("time,steps\n0.42,4\n").verdict, Verdict::passed);
  EXPECT_EQ(folder.run("time,steps\n1.5,90\n", R"(, "step": "1/60")").verdict, Verdict::passed);
  const auto early = folder.run("time,steps\n1,10\n", R"(, "stop_time": 0.5)");
  EXPECT_EQ(early.verdict, Verdict::error);
  EXPECT_THAT(early.text(), HasSubstr("ended at 0.5 s, before the last expected row at 1 s"));
}

TEST(Cases, ReportsAFailedRunAsAnErrorOfTheCase) {
  const CaseFolder folder;
  const auto unknown = folder.run("time,real_uot\n0,0\n");
  EXPECT_EQ(unknown.verdict, Verdict::error);
  EXPECT_THAT(unknown.text(), AllOf(HasSubstr("out.csv"), HasSubstr("'real_uot'"), HasSubstr("real_out")));
  EXPECT_THAT(folder.run("time,real_out [km]\n0,0\n").text(), HasSubstr("[metre]"));
  EXPECT_THAT(folder.run("time\n0\n").text(), HasSubstr("a column for the time only"));
  EXPECT_THAT(folder.run("time,steps\n1,1\n", R"(, "parameters": {"gian": 1})").text(), HasSubstr("gain"));
  EXPECT_THAT(folder.run("time,steps\n1,1\n", R"(, "parameters": {"fault": "error"})").text(), HasSubstr("fmi2Error"));
#ifndef __SANITIZE_ADDRESS__
  const auto crashed = folder.run("time,steps\n1,1\n", R"(, "parameters": {"fault": "crash"})", true);
  EXPECT_EQ(crashed.verdict, Verdict::error);
  EXPECT_THAT(crashed.text(), HasSubstr("SIGSEGV"));
#endif
}

TEST(Cases, MistakesOfAFileAreListed) {
  const CaseFolder folder;
  const auto error = [&](const std::string& text) {
    folder.write("cases.json", text);
    return test::input_error([&] { static_cast<void>(cases::read_cases(folder.path() / "cases.json")); });
  };
  EXPECT_THAT(error(R"({"cases": {}})"), HasSubstr("at least one case"));
  EXPECT_THAT(
      error(R"({"cases": {"a": {}, "b": {"expected": "nothing.csv", "stpe": 1}}})"),
      AllOf(HasSubstr("/cases/a"), HasSubstr("'expected' is missing"), HasSubstr("nothing.csv"), HasSubstr("stpe")));
  EXPECT_THAT(error(R"({"cases": {"a": {"expected": "thing.fmu", "tolerance": {"absolute": -1}}}})"),
              HasSubstr("/cases/a/tolerance/absolute"));
}

TEST(Cases, TheProgramPrintsWhatFailedAndWritesJunit) {
  const CaseFolder folder;
  folder.write("good.csv", "time,steps\n1,10\n");
  folder.write("bad.csv", "time,steps\n0,0\n1,11\n");
  folder.write("thing.mebots-test.json", R"({"fmu": "thing.fmu", "cases": {
      "good": {"expected": "good.csv"}, "bad": {"expected": "bad.csv"}}})");
  const auto run = [&](std::vector<std::string> words) {
    words.insert(words.begin(), "test");
    return test::run_program(words, folder.path());
  };
  const auto both = run({"thing.mebots-test.json", "--junit", "report.xml", "--out", "results"});
  EXPECT_EQ(both.code, 1);
  EXPECT_EQ(both.out,
            "passed good: 1 rows of 1 variables\n"
            "failed bad: at 1 s steps is 10, expected 11 (difference -1, tolerance 0)\n"
            "1 of 2 cases passed\n");
  const auto junit = test::read_file(folder.path() / "report.xml");
  EXPECT_THAT(junit,
              AllOf(HasSubstr(R"(tests="2" failures="1" errors="0")"), HasSubstr(R"(classname="thing" name="bad")"),
                    HasSubstr(R"(<failure message="at 1 s steps is 10)")));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "results" / "bad" / "results.csv"));

  EXPECT_EQ(run({"thing.fmu", "thing.mebots-test.json", "--case", "go*"}).code, 0);
  EXPECT_EQ(run({"thing.mebots-test.json", "--case", "none"}).code, 2);
  EXPECT_EQ(run({"other.fmu", "thing.mebots-test.json"}).code, 2);
  folder.write("thing.mebots-test.json", R"({"cases": {"good": {"expected": "good.csv"}}})");
  EXPECT_THAT(run({"thing.mebots-test.json"}).err, HasSubstr("name no FMU"));
}

}  // namespace
}  // namespace mebots::master
