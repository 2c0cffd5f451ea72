// SPDX-License-Identifier: Apache-2.0
// Tests that a mission has the same bits on every x86-64 processor. It must call no function for which glibc selects a
// variant by processor.
#include "missions.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <regex>

namespace mebots::system_test {
namespace {

/// While this object exists, glibc in newly started programs acts as if the processor lacked these features.
class PlainProcessor {
 public:
  PlainProcessor() { ::setenv("GLIBC_TUNABLES", "glibc.cpu.hwcaps=-AVX,-AVX2,-AVX512F,-FMA,-FMA4,-BMI1,-BMI2", 1); }
  ~PlainProcessor() { ::unsetenv("GLIBC_TUNABLES"); }
  PlainProcessor(const PlainProcessor&) = delete;
  PlainProcessor& operator=(const PlainProcessor&) = delete;
};

std::string output_of(const std::string& command) {
  FILE* pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) return "";
  std::string output;
  std::array<char, 4096> buffer{};
  for (std::size_t n = 0; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) output.append(buffer.data(), n);
  return ::pclose(pipe) == 0 ? output : "";
}

TEST(Processors, MissionHasTheSameBitsWithoutAvxFmaAndBmi) {
  const Folder folder;
  const auto config = write(folder / "gate_easy.json", shipped_config("gate_easy"));
  const auto flight = fly(config, folder / "this");
  ASSERT_EQ(flight.exit_code, 0) << flight.output;
  // Calls glibc's exp() through Python. exp() has variants for different processors, so the bits show whether the
  // features are disabled.
  const std::string sum =
      "python3 -c 'from math import exp; print(hash(tuple(exp(-i / 7300) for i in range(100000))))'";
  const auto exponentials = output_of(sum);

  const PlainProcessor plain;
  const auto other = fly(config, folder / "plain");
  ASSERT_EQ(other.exit_code, 0) << other.output;
  EXPECT_TRUE(other.results == flight.results) << "results.csv differs without AVX, FMA and BMI";
  if (output_of(sum) == exponentials) GTEST_SKIP() << "glibc has nothing to choose from here";
}

TEST(Processors, NoProgramOfOursAsksTheMachineForAFunctionThatIsNotExact) {
  const std::regex inexact(
      R"(\bU ((a?(sin|cos|tan)h?|atan2|sincos|exp(2|10|m1)?|log(2|10|1p)?|pow|cbrt|hypot|erfc?|[lt]gamma)[fl]?)@)");
  for (const std::string file : {FMU_BATTERY, FMU_MOTORS, FMU_SOC, FMU_WORLD, MEBOTS_PROGRAM}) {
    const auto symbols = output_of("nm --dynamic --undefined-only '" + file + "'");
    ASSERT_NE(symbols.find("@GLIBC_"), std::string::npos) << file << ": " << symbols;
    std::smatch found;
    EXPECT_FALSE(std::regex_search(symbols, found, inexact)) << file << " asks for " << found[1];
  }
}

}  // namespace
}  // namespace mebots::system_test
