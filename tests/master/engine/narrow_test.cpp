// SPDX-License-Identifier: Apache-2.0
// Tests connections to inputs whose type cannot represent all values of the output, with tests/fmus/widths.cpp.
#include "test_system.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <string>

namespace mebots::master {
namespace {

using test::TestRun;
using testing::AllOf;
using testing::HasSubstr;

/// Returns a config in which the output `from` of a is connected to the input `to` of b. `inputs` are values of a.
std::string widths(const std::string& inputs, const std::string& from, const std::string& to,
                   const std::string& more = R"(, "narrow": true)") {
  return fmt::format(R"({{"step": 0.5, "stop_time": 1, "instances": {{
    "a": {{"fmu": "{0}", "parameters": {{{1}}}}}, "b": {{"fmu": "{0}"}}}},
    "connections": [{{"from": "a.{2}", "to": "b.{3}"{4}}}]}})",
                     WIDTHS_FMU, inputs, from, to, more);
}

double narrowed(const std::string& inputs, const std::string& from, const std::string& to, const std::string& out) {
  TestRun run(widths(inputs, from, to));
  return run.to_end().column("b." + out).back();
}

std::string narrowing_error(const std::string& inputs, const std::string& from, const std::string& to) {
  try {
    TestRun(widths(inputs, from, to)).to_end();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Narrow, TakesTheNearestValueOfTheInputsType) {
  // Results contain the shortest text of a Float32, such as 0.1. Therefore this value is compared as a float.
  EXPECT_EQ(static_cast<float>(narrowed(R"("wide": 0.10000000149)", "wide_out", "single", "single_out")), 0.1F);
  EXPECT_EQ(narrowed(R"("long": 255)", "long_out", "byte", "byte_out"), 255);
  EXPECT_EQ(narrowed(R"("long": 9007199254740993)", "long_out", "wide", "wide_out"), 9007199254740992.0);
  EXPECT_EQ(narrowed(R"("huge": 200)", "huge_out", "byte", "byte_out"), 200);
}

TEST(Narrow, EndsTheRunAtAValueOutOfRange) {
  EXPECT_THAT(narrowing_error(R"("wide": 1e39)", "wide_out", "single"),
              AllOf(HasSubstr("'b' at 0 s"), HasSubstr("'single' would be 1e+39, which is not in the range of Float32"),
                    HasSubstr("it comes from a.wide_out")));
  EXPECT_THAT(narrowing_error(R"("long": 256)", "long_out", "byte"), HasSubstr("'byte' would be 256"));
  EXPECT_THAT(narrowing_error(R"("long": -1)", "long_out", "byte"), HasSubstr("'byte' would be -1"));
  EXPECT_THAT(narrowing_error(R"("long": -1)", "long_out", "huge"), HasSubstr("'huge' would be -1"));
  EXPECT_THAT(narrowing_error("", "huge_out", "long"), HasSubstr("'long' would be 18446744073709551615"));
}

TEST(WholeNumbers, HaveAllValuesOfUInt64InAConfig) {
  const auto config = [](const std::string& value) { return widths(R"("huge": )" + value, "huge_out", "huge", ""); };
  for (const auto* value : {"0", "9223372036854775807", "9223372036854775808", "18446744073709551615"}) {
    TestRun run(config(value));
    EXPECT_THAT(run.to_end().csv(), HasSubstr(fmt::format(",{},", value)));
  }
  const auto refusal = [&](const std::string& value) { return test::input_error([&] { TestRun run(config(value)); }); };
  for (const auto* value : {"18446744073709551616", "-1", "9223372036854775808.5", "\"9223372036854775808\""}) {
    EXPECT_THAT(refusal(value), HasSubstr("a whole number from 0 to 18446744073709551615")) << value;
  }
  EXPECT_THAT(test::input_error([] { TestRun run(widths(R"("long": 9223372036854775808)", "long_out", "long", "")); }),
              AllOf(HasSubstr("'long' is of type Int64"), HasSubstr("not '9223372036854775808'")));
}

TEST(Narrow, IsNamedWhereItWouldHelpAndRefusedWhereItWouldNot) {
  const auto refusal = [](const std::string& config) { return test::input_error([&] { TestRun run(config); }); };
  EXPECT_THAT(refusal(widths("", "wide_out", "single", "")),
              AllOf(HasSubstr("\"narrow\": true rounds to the nearest value"), HasSubstr("ends the run")));
  EXPECT_THAT(refusal(widths("", "wide_out", "long")), HasSubstr("the types differ"));
  EXPECT_THAT(refusal(widths("", "huge_out", "wide")), HasSubstr("the types differ"));
  EXPECT_THAT(refusal(widths("", "single_out", "wide")), HasSubstr("Remove \"narrow\""));
  EXPECT_THAT(refusal(widths("", "long_out", "byte", R"(, "narrow": true, "map": {"300": 3})")),
              HasSubstr("no effect on a connection with a \"map\""));
}

}  // namespace
}  // namespace mebots::master
