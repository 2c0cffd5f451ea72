// SPDX-License-Identifier: Apache-2.0
#include "support.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

namespace mebots::check {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> of(const std::string& crime, double deadline_s = 30) {
  Workshop workshop;
  return findings(workshop.culprit(crime), true, deadline_s);
}

TEST(CheckBehaviour, AnFmuThatDoesRightHasNoFindings) {
  EXPECT_THAT(of("none"), IsEmpty());
  EXPECT_THAT(findings(LAG_FMU, true), IsEmpty());
}

TEST(CheckBehaviour, WrongValuesAreFound) {
  EXPECT_THAT(of("start"),
              Contains(HasSubstr("error: gain is 3 in initialisation mode; modelDescription.xml says start 2")));
  EXPECT_THAT(of("nan"), Contains(HasSubstr("error: y is nan at 0.1 s")));
  EXPECT_THAT(of("limits"), Contains(HasSubstr("warning: y = 1000 at 0.1 s is outside of its min and max")));
  EXPECT_THAT(of("coarse"), Contains(HasSubstr("after twice as many halves")));
}

TEST(CheckBehaviour, StateThatLeaksBetweenRunsAndInstancesIsFound) {
  EXPECT_THAT(of("global"), Contains(HasSubstr("error: beside another instance: y is")));
  EXPECT_THAT(of("reset"), Contains(HasSubstr("error: after fmi2Reset after some steps: y is")));
  EXPECT_THAT(of("state"), Contains(HasSubstr("error: after fmi2SetFMUstate: y is")));
  EXPECT_THAT(of("bytes"), Contains(HasSubstr("error: after restoring a serialised state in another instance: y is")));
}

TEST(CheckBehaviour, WhatIsLeftBehindIsCounted) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the address sanitizer owns malloc, which the check asks for its count";
#endif
  EXPECT_THAT(of("leak"),
              Contains(testing::ContainsRegex("100 instances that came and went left 1[0-9]{5} bytes of heap")));
  EXPECT_THAT(of("file"), Contains(HasSubstr("100 instances that came and went left 100 open files behind")));
}

TEST(CheckBehaviour, IllegalCallsThatAreAcceptedAreFound) {
  EXPECT_THAT(of("order"), Contains(HasSubstr("warning: fmi2DoStep before initialisation was answered fmi2OK")));
  EXPECT_THAT(of("fixed"),
              Contains(HasSubstr("setting the fixed parameter gain after initialisation was answered fmi2OK")));
}

TEST(CheckBehaviour, ACrashIsAFindingThatNamesSignalAndCall) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the address sanitizer answers a crash's signal before the check can";
#endif
  EXPECT_THAT(
      of("crash"),
      Contains(HasSubstr("error: crashed with SIGSEGV (Segmentation fault) in fmi2DoStep before initialisation")));
  EXPECT_THAT(of("null"), Contains(HasSubstr("SIGSEGV (Segmentation fault) in fmi2GetReal with null arrays")));
  EXPECT_THAT(of("free"), Contains(HasSubstr("SIGABRT (Aborted) in fmi2FreeInstance in initialisation mode")));
}

TEST(CheckBehaviour, AnFmuThatEndsTheProcessOrHangsIsAFinding) {
  EXPECT_THAT(of("exit"),
              Contains(HasSubstr("error: ended the process with exit code 3 in fmi2DoStep(t = 0, h = 0.1)")));
  EXPECT_THAT(of("hang", 0.2), Contains(HasSubstr("no answer within 0.2 s from fmi2DoStep(t = 0, h = 0.1)")));
}

TEST(CheckBehaviour, TheLoggersArgumentsAreLookedAt) {
  EXPECT_THAT(of("name"),
              Contains(HasSubstr("the logger was called with the instance name \"somebody\" instead of \"illegal\"")));
  EXPECT_THAT(of("category"),
              Contains(HasSubstr("a message is of category \"gossip\", which LogCategories does not list")));
}

TEST(CheckBehaviour, ReferenceTracesAreReplayed) {
  Workshop workshop;
  const auto with_trace = [&](const std::string& out) {
    return findings(workshop.culprit("none", {{"documentation/reference/culprit_in.csv", "time,u\n0,0\n1,3\n"},
                                              {"documentation/reference/culprit_out.csv", out}}),
                    true);
  };
  // y = 6 (1 - exp(-1)) one second after u became 3.
  EXPECT_THAT(with_trace("time,y\n0,0\n1,0\n2,3.792723352971346\n"), IsEmpty());
  EXPECT_THAT(
      with_trace("time,y\n0,0\n1,0\n2,3.9\n"),
      Contains(HasSubstr("culprit_out.csv: first divergence at 2 s: y is 3.792723352971346, the trace has 3.9")));
  EXPECT_THAT(with_trace("time,z\n0,0\n"), Contains(HasSubstr("\"z\" is no number of this FMU")));
}

TEST(CheckBehaviour, MissingLibrariesAndForeignBinariesAreNamed) {
  Workshop workshop;
  EXPECT_THAT(findings(workshop.described(culprit_description("none")), true), Contains(HasSubstr("is no ELF file")));
}

TEST(CheckReport, IsValidJson) {
  Workshop workshop;
  const auto report = check_fmu(workshop.culprit("nan"), {});
  const auto json = nlohmann::json::parse(to_json(report));
  EXPECT_FALSE(json.at("clean"));
  EXPECT_GT(json.at("errors"), 0);
  bool found = false;
  for (const auto& check : json.at("checks"))
    for (const auto& finding : check.at("findings")) found = found || finding.at("text") == "y is nan at 0.1 s";
  EXPECT_TRUE(found);
  EXPECT_THAT(to_text(report), HasSubstr("y is nan at 0.1 s\n           -> "));
}

}  // namespace
}  // namespace mebots::check
