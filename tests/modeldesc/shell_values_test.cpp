// SPDX-License-Identifier: Apache-2.0
#include "lag_fmu.hpp"

#include "mebots/fmu/binary_ref.hpp"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <limits>

namespace mebots::test {
namespace {

using testing::HasSubstr;

fmu::BinaryRef binary(Lag& lag, const std::string& name) {
  return {lag.integer(name + ".base.lo"), lag.integer(name + ".base.hi"), lag.integer(name + ".size")};
}

TEST(ShellValues, StartAtTheDescriptionsValues) {
  Lag lag;
  lag.start();
  EXPECT_EQ(lag.real("left.time_constant"), 1);
  EXPECT_EQ(lag.real("right.time_constant"), 2);
  EXPECT_EQ(lag.real("gain"), 1);
  EXPECT_EQ(lag.string("label.file"), "label.txt");
  EXPECT_TRUE(lag.boolean("enabled"));
  EXPECT_EQ(lag.integer("trouble"), 0);
  EXPECT_EQ(lag.string("label"), "a lag");
  EXPECT_EQ(lag.integer("message.size"), 0);
}

TEST(ShellValues, FollowTheAnalyticSolutionInStepsOfAnySize) {
  Lag lag;
  ASSERT_EQ(lag.set("left.u", 5), fmi2OK);
  ASSERT_EQ(lag.set("right.u", -3), fmi2OK);
  lag.start();
  double t = 0;
  for (const double h : {0.1, 0.001, 0.25, 1e-6, 0.5, 0.05}) {
    ASSERT_EQ(lag.step(t, h), fmi2OK) << lag.last_message();
    t += h;
    // The result is a product of up to six exponentials. Each adds a relative rounding error of about 1e-16.
    EXPECT_NEAR(lag.real("left.y"), 5 * (1 - std::exp(-t)), 1e-14);
    EXPECT_NEAR(lag.real("right.y"), -3 * (1 - std::exp(-t / 2)), 1e-14);
  }
  EXPECT_EQ(lag.integer("steps"), 6);
}

TEST(ShellValues, OutputsReadInInitialisationModeFollowWhatWasSetBefore) {
  Lag lag;
  ASSERT_EQ(library().setup_experiment(lag.component(), 0, 0, 0, 0, 0), fmi2OK);
  ASSERT_EQ(library().enter_initialization_mode(lag.component()), fmi2OK);
  EXPECT_EQ(lag.real("left.y"), 0);
  EXPECT_FALSE(lag.boolean("moving"));
  ASSERT_EQ(lag.set("left.initial", 2), fmi2OK);
  ASSERT_EQ(lag.set("left.u", 4), fmi2OK);
  EXPECT_EQ(lag.real("left.y"), 2);
  EXPECT_TRUE(lag.boolean("moving"));
  ASSERT_EQ(library().exit_initialization_mode(lag.component()), fmi2OK);
  EXPECT_EQ(lag.real("left.y"), 2);
}

TEST(ShellValues, AreRefusedOutsideTheirLimitsWithNothingChanged) {
  Lag lag;
  lag.start();
  ASSERT_EQ(lag.set("left.u", 7), fmi2OK);
  const std::array references = {LagFmu::get().reference("left.u"), LagFmu::get().reference("right.u")};
  const std::array values = {1.0, 100.5};
  EXPECT_EQ(library().set_real(lag.component(), references.data(), 2, values.data()), fmi2Error);
  EXPECT_EQ(lag.last_message(), "fmi2SetReal: right.u = 100.5 V is above its maximum of 100 V");
  EXPECT_EQ(lag.real("left.u"), 7);  // the failed call has set no value
  EXPECT_EQ(lag.set("left.u", -101), fmi2Error);
  EXPECT_THAT(lag.last_message(), HasSubstr("below its minimum of -100 V"));
  EXPECT_EQ(lag.set("left.u", std::nan("")), fmi2Error);
  EXPECT_THAT(lag.last_message(), HasSubstr("left.u = nan: a finite number is needed"));
  EXPECT_EQ(lag.set("gain", std::numeric_limits<double>::infinity()), fmi2Error);
  EXPECT_EQ(lag.set_integer("trouble", 3), fmi2Error);
  EXPECT_THAT(lag.last_message(),
              HasSubstr("trouble = 3 is not one of its values (0 = none, 1 = mendable, 2 = fatal)"));
  EXPECT_EQ(lag.set_boolean("enabled", 2), fmi2Error);
  EXPECT_EQ(lag.set_string("note", nullptr), fmi2Error);
  EXPECT_EQ(lag.real("left.u"), 7);
}

TEST(ShellValues, CannotBeSetForOutputsAndForFixedParametersAfterInitialisation) {
  Lag lag;
  EXPECT_EQ(lag.set("left.y", 1), fmi2Error);
  EXPECT_THAT(lag.last_message(), HasSubstr("left.y is an output"));
  lag.start();
  EXPECT_EQ(lag.set("left.time_constant", 3), fmi2Error);
  EXPECT_THAT(lag.last_message(), HasSubstr("left.time_constant is a fixed parameter"));
  EXPECT_EQ(lag.set("gain", 2), fmi2OK);  // the parameter is tunable
  ASSERT_EQ(lag.set("left.u", 1), fmi2OK);
  ASSERT_EQ(lag.step(0, 50), fmi2OK);
  EXPECT_NEAR(lag.real("left.y"), 2, 1e-12);  // the state is steady: the remaining distance is exp(-50)
}

TEST(ShellValues, UnknownReferencesAndWrongTypesAreNamed) {
  Lag lag;
  lag.start();
  fmi2ValueReference reference = 9999;
  double value = 0;
  EXPECT_EQ(library().get_real(lag.component(), &reference, 1, &value), fmi2Error);
  EXPECT_THAT(lag.last_message(), HasSubstr("there is no value reference 9999; lag has 0 to "));
  reference = LagFmu::get().reference("label");
  EXPECT_EQ(library().get_real(lag.component(), &reference, 1, &value), fmi2Error);
  EXPECT_THAT(lag.last_message(), HasSubstr("is label of type String, not Real; use the functions for String"));
  EXPECT_EQ(library().get_real(lag.component(), nullptr, 1, &value), fmi2Error);
  EXPECT_THAT(lag.last_message(), HasSubstr("the array vr is a null pointer"));
  reference = LagFmu::get().reference("left.y");
  EXPECT_EQ(library().get_real(lag.component(), &reference, 1, nullptr), fmi2Error);
  EXPECT_EQ(library().get_real(lag.component(), nullptr, 0, nullptr), fmi2OK);
}

TEST(ShellValues, TextsAndBytesTravelBothWays) {
  Lag lag;
  ASSERT_EQ(lag.set_string("note",
                           "Gr\xC3\xBC\xC3\x9F"
                           "e, 50 %"),
            fmi2OK);
  lag.start();
  EXPECT_EQ(lag.string("label"),
            "a lag: Gr\xC3\xBC\xC3\x9F"
            "e, 50 %");
  const std::array<std::uint8_t, 3> message = {1, 2, 250};
  const fmu::BinaryRef sent = fmu::BinaryRef::to(message);
  const std::array references = {LagFmu::get().reference("message.base.lo"), LagFmu::get().reference("message.base.hi"),
                                 LagFmu::get().reference("message.size")};
  const std::array values = {sent.base_lo, sent.base_hi, sent.size};
  ASSERT_EQ(library().set_integer(lag.component(), references.data(), 3, values.data()), fmi2OK);
  ASSERT_EQ(lag.step(0, 1), fmi2OK);
  EXPECT_EQ(lag.integer("message.sum"), 253);
  ASSERT_EQ(lag.step(1, 1), fmi2OK);
  EXPECT_THAT(binary(lag, "history").bytes(), testing::ElementsAre(1, 2));
  EXPECT_EQ(lag.string("history.text"), "1 2");
}

TEST(ShellValues, AStepThatEndsInTheNanosecondReachedAlreadyChangesNothing) {
  Lag lag;
  lag.start(10);
  EXPECT_EQ(lag.step(10, 2e-13), fmi2OK);  // a tool that sums its steps may have this remainder
  EXPECT_EQ(lag.integer("steps"), 0);
  EXPECT_EQ(lag.step(10, 1e-9), fmi2OK);
  EXPECT_EQ(lag.integer("steps"), 1);
}

TEST(ShellValues, ALateStartDoesNotMakeAnotherPointPass) {
  constexpr double kUnixTime = 1.7e9;  // doubles are 2.4e-7 s apart
  Lag lag;
  lag.start(kUnixTime);
  EXPECT_EQ(lag.step(kUnixTime, 0.002), fmi2OK);
  EXPECT_EQ(lag.step(kUnixTime + 0.002, 0.002), fmi2OK);
  EXPECT_EQ(lag.step(kUnixTime + 0.002, 0.002), fmi2Error) << "that step was made";
  EXPECT_EQ(lag.integer("steps"), 2);
  Lag other;
  other.start(kUnixTime);
  EXPECT_EQ(other.step(kUnixTime + 1.5, 0.002), fmi2Error);
}

TEST(ShellValues, AStepThatDisagreesAboutTheTimeIsRefused) {
  Lag lag;
  lag.start(10);
  EXPECT_EQ(lag.step(10.1, 0.1), fmi2Error);
  EXPECT_EQ(lag.last_message(), "fmi2DoStep: currentCommunicationPoint = 10.1 s, but this instance is at 10 s");
  EXPECT_EQ(lag.step(10, 0), fmi2Error);
  EXPECT_EQ(lag.step(10, -0.1), fmi2Error);
  EXPECT_EQ(lag.step(10, std::nan("")), fmi2Error);
  EXPECT_EQ(lag.step(std::nan(""), 0.1), fmi2Error);
  EXPECT_EQ(lag.integer("steps"), 0);
  EXPECT_EQ(lag.step(10, 0.1), fmi2OK);
  double last = 0;
  EXPECT_EQ(library().get_real_status(lag.component(), fmi2LastSuccessfulTime, &last), fmi2OK);
  EXPECT_DOUBLE_EQ(last, 10.1);
}

TEST(ShellValues, ATenThousandFoldSumOfStepsDoesNotDrift) {
  Lag lag;
  ASSERT_EQ(lag.set("left.u", 1), fmi2OK);
  lag.start();
  double summed = 0;  // sums the steps as some tools do
  for (int i = 0; i < 10000; ++i) {
    ASSERT_EQ(lag.step(summed, 0.1), fmi2OK) << lag.last_message();
    summed += 0.1;
  }
  double last = 0;
  ASSERT_EQ(library().get_real_status(lag.component(), fmi2LastSuccessfulTime, &last), fmi2OK);
  EXPECT_NEAR(last, 1000, 1e-9);
}

TEST(ShellValues, AStepPastTheStopTimeIsRefused) {
  Lag lag;
  ASSERT_EQ(library().setup_experiment(lag.component(), 0, 0, 0, 1, 0.3), fmi2OK);
  ASSERT_EQ(library().enter_initialization_mode(lag.component()), fmi2OK);
  ASSERT_EQ(library().exit_initialization_mode(lag.component()), fmi2OK);
  EXPECT_EQ(lag.step(0, 0.1), fmi2OK);
  EXPECT_EQ(lag.step(0.1, 0.1), fmi2OK);
  EXPECT_EQ(lag.step(0.1 + 0.1, 0.2), fmi2Error);
  EXPECT_THAT(lag.last_message(), HasSubstr("after the stopTime of 0.3 s"));
  EXPECT_EQ(lag.step(0.1 + 0.1, 0.1), fmi2OK);
}

TEST(ShellValues, AreSeparateForTwoInstances) {
  Lag one("one");
  Lag two("two");
  ASSERT_EQ(one.set("left.u", 1), fmi2OK);
  ASSERT_EQ(two.set("left.u", 2), fmi2OK);
  one.start();
  two.start();
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(one.step(i, 1), fmi2OK);
    ASSERT_EQ(two.step(i, 1), fmi2OK);
  }
  EXPECT_EQ(two.real("left.y"), 2 * one.real("left.y"));
  EXPECT_EQ(one.integer("steps"), 3);
}

TEST(ShellValues, AreBackAtTheStartAfterReset) {
  Lag lag;
  ASSERT_EQ(lag.set("left.u", 5), fmi2OK);
  ASSERT_EQ(lag.set("left.time_constant", 3), fmi2OK);
  lag.start();
  ASSERT_EQ(lag.step(0, 1), fmi2OK);
  ASSERT_EQ(library().reset(lag.component()), fmi2OK);
  lag.start();
  EXPECT_EQ(lag.real("left.u"), 0);
  EXPECT_EQ(lag.real("left.y"), 0);
  EXPECT_EQ(lag.real("left.time_constant"), 1);
  EXPECT_EQ(lag.integer("steps"), 0);
}

}  // namespace
}  // namespace mebots::test
