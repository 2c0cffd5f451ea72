// SPDX-License-Identifier: Apache-2.0
#include "fmi/fmu.hpp"
#include "fmi/library_state.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

namespace mebots::master {
namespace {

using testing::HasSubstr;
using testing::Optional;

const std::filesystem::path kBinaryDir = MEBOTS_BINARY_DIR;

std::filesystem::path leftover(const std::string& place) {
  return kBinaryDir / "test_fmus" / ("leftover_" + place + ".fmu");
}

TEST(CleanFmus, ThePageListsEachFunctionThatChangesTheProcess) {
  std::ifstream file(std::filesystem::path(MEBOTS_SOURCE_DIR) / "docs/master/clean-fmus.md");
  const std::string page{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  for (const auto& function : process_functions()) {
    EXPECT_THAT(page, HasSubstr("`" + std::string(readable_name(function)) + "`")) << function.symbol;
    EXPECT_THAT(page, HasSubstr("| " + std::string(function.what) + " |")) << function.symbol;
  }
}

TEST(CleanFmus, TheShippedFmusAreCleanWhenTheyAreLoaded) {
  for (const auto* const name : {"fmu_battery.fmu", "fmu_motors.fmu", "fmu_world.fmu", "fmu_soc.fmu"}) {
    Fmu fmu(kBinaryDir / "fmus" / name);
    fmu.require_library();
    EXPECT_EQ(fmu.uncleanliness(), std::nullopt) << name;
    EXPECT_EQ(fmu.state_elsewhere(), std::nullopt) << name;
  }
}

TEST(CleanFmus, AnImportIsSeenInTheFileBeforeTheLibraryIsLoaded) {
  EXPECT_THAT(Fmu(leftover("rand")).uncleanliness(), Optional(HasSubstr("rand, which changes random numbers")));
  EXPECT_THAT(Fmu(leftover("environment")).uncleanliness(), Optional(HasSubstr("setenv")));
  EXPECT_EQ(Fmu(leftover("nothing")).uncleanliness(), std::nullopt);
  EXPECT_EQ(Fmu(leftover("static_variable")).uncleanliness(), std::nullopt);
}

TEST(CleanFmus, ImportsShowWhatAnFmuCanChangeInTheProcess) {
  EXPECT_EQ(Fmu(leftover("nothing")).imports().reach, ProcessReach::nothing);
  EXPECT_EQ(Fmu(leftover("environment")).imports().reach, ProcessReach::everything);
  EXPECT_EQ(Fmu(kBinaryDir / "fmus/fmu_battery.fmu").imports().reach, ProcessReach::descriptors);  // files
  EXPECT_EQ(Fmu(kBinaryDir / "fmus/fmu_soc.fmu").imports().reach, ProcessReach::everything);       // loads devices
  EXPECT_EQ(reach_of("dlsym"), ProcessReach::everything);
  EXPECT_EQ(reach_of("fclose"), ProcessReach::descriptors);
  EXPECT_EQ(reach_of("sin"), ProcessReach::nothing);
}

TEST(CleanFmus, AStaticObjectWithMemoryOfItsOwnIsSeenWhenTheLibraryIsLoaded) {
  Fmu fmu(leftover("static_object"));
  fmu.require_library();
  EXPECT_THAT(fmu.uncleanliness(), Optional(HasSubstr("static objects of leftover.so own memory")));
}

TEST(CleanFmus, RandomNumbersStartAsInAFreshProcess) {
  renew_c_library();
  const int first = std::rand();
  constexpr int kFirstOfAll = 1804289383;  // first number of the GNU C library without srand()
  EXPECT_EQ(first, kFirstOfAll);
  std::srand(7);
  std::rand();
  renew_c_library();
  EXPECT_EQ(std::rand(), first);
  const double drawn = drand48();
  EXPECT_DOUBLE_EQ(drawn, 11.0 / 281474976710656.0);  // POSIX: X = a 0 + c with c = 0xB, divided by 2^48
}

}  // namespace
}  // namespace mebots::master
