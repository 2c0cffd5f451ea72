// SPDX-License-Identifier: Apache-2.0
#include "support.hpp"

namespace mebots::battery {
namespace {

Converter core() {
  return load_converter(kParams / "converters.json", "core", "soc.converter");
}

TEST(Converter, EfficiencyIsTheTablesAtItsPointsAndLinearBetween) {
  // MESSY's table, in ampere; the rail is at 1.2 V.
  EXPECT_NEAR(core().efficiency(1.2 * 0.01), 0.888, 1e-12);
  EXPECT_NEAR(core().efficiency(1.2 * 0.1), 0.906, 1e-12);
  EXPECT_NEAR(core().efficiency(1.2 * 0.055), (0.888 + 0.906) / 2, 1e-12);
}

TEST(Converter, EfficiencyIsHeldBeyondTheEndsOfTheTable) {
  EXPECT_EQ(core().efficiency(0), 0.779);
  EXPECT_EQ(core().efficiency(1.2 * 1e-7), 0.779);
  EXPECT_EQ(core().efficiency(1.2 * 0.4), 0.85);
  EXPECT_EQ(core().efficiency(1.2 * 10), 0.85);
}

TEST(Converter, InputIsOutputDividedByEfficiency) {
  EXPECT_NEAR(core().input_power_w(1.2 * 0.1), 1.2 * 0.1 / 0.906, 1e-15);
  EXPECT_EQ(core().input_power_w(0), 0);
}

TEST(Converter, OutputForAnInputIsTheInverse) {
  for (const double input_w : {0.0, 1e-6, 1e-3, 0.05, 0.3, 0.6, 3.0}) {
    const double output_w = core().output_power_w(input_w);
    EXPECT_LE(output_w, input_w);
    EXPECT_NEAR(core().input_power_w(output_w), input_w, 1e-14 * std::max(input_w, 1.0));
  }
}

TEST(Converter, DirectLosesNothing) {
  const Converter direct = load_converter(kParams / "converters.json", "direct", "motors.converter");
  EXPECT_EQ(direct.input_power_w(7.5), 7.5);
  EXPECT_EQ(direct.output_power_w(7.5), 7.5);
}

TEST(Converter, UnknownNameListsTheKnownOnes) {
  Parameters wrong;
  wrong.load_converter[load::camera] = "buck";
  EXPECT_THAT(error_of([&] { Bench{wrong}; }), testing::AllOf(testing::HasSubstr("camera.converter = \"buck\""),
                                                              testing::HasSubstr("'core', 'direct'")));
}

}  // namespace
}  // namespace mebots::battery
