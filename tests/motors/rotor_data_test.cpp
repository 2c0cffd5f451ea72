// SPDX-License-Identifier: Apache-2.0
// Compares the rotor files with the table from which they were computed, and tests that invalid files are rejected.
#include "support.hpp"

#include <cmath>

namespace mebots::motors {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(RotorData, SteadySpeedIsTheTablesAtEveryBenchPoint) {
  const RotorData rotor = bench_rotor();
  for (const BenchRow& row : bench_rows()) {
    // The numbers in the file are rounded to six digits.
    EXPECT_NEAR(rotor.steady_speed_rad_per_s(row.command * row.voltage_v), row.speed_rad_per_s,
                2e-5 * row.speed_rad_per_s + 1e-9);
  }
}

TEST(RotorData, ThrustCoefficientIsTheLeastSquaresFitOfTheBench) {
  double upper = 0;
  double lower = 0;
  double squares = 0;
  const RotorData rotor = bench_rotor();
  for (const BenchRow& row : bench_rows()) {
    const double w2 = row.speed_rad_per_s * row.speed_rad_per_s;
    upper += row.thrust_n * w2;
    lower += w2 * w2;
    squares += std::pow(row.thrust_n - rotor.thrust_coefficient * w2, 2);
  }
  EXPECT_NEAR(rotor.thrust_coefficient, upper / lower, 1e-6 * rotor.thrust_coefficient);
  EXPECT_NEAR(std::sqrt(squares / 16), 1.85e-3, 1e-5);  // the residual that the file and the README state
}

TEST(RotorData, PowerIsTheLeastSquaresFitOfTheBench) {
  // Normal equations of the least-squares fit P = a w + b F to all rows: speed w, thrust F and power P of one rotor. P
  // excludes the avionics' power.
  double ww = 0;
  double wf = 0;
  double ff = 0;
  double wp = 0;
  double fp = 0;
  const auto rows = bench_rows();
  const double avionics_w = rows[0].current_a * rows[0].voltage_v;
  for (const BenchRow& row : rows) {
    const double w = row.speed_rad_per_s;
    const double power_w = (row.current_a * row.voltage_v - avionics_w) / 4;
    ww += w * w;
    wf += w * row.thrust_n;
    ff += row.thrust_n * row.thrust_n;
    wp += w * power_w;
    fp += row.thrust_n * power_w;
  }
  const double determinant = ww * ff - wf * wf;
  const RotorData rotor = bench_rotor();
  EXPECT_NEAR(rotor.power_per_speed_ws_per_rad, (wp * ff - fp * wf) / determinant,
              1e-5 * rotor.power_per_speed_ws_per_rad);
  EXPECT_NEAR(rotor.power_per_thrust_w_per_n, (fp * ww - wp * wf) / determinant, 1e-5 * rotor.power_per_thrust_w_per_n);
}

TEST(RotorData, SpeedIsExtrapolatedLinearlyBeyondTheTable) {
  const RotorData rotor = bench_rotor();
  EXPECT_NEAR(rotor.steady_speed_rad_per_s(4) - rotor.steady_speed_rad_per_s(3.5), 0.5 * 696.172, 1e-9);
  EXPECT_EQ(rotor.steady_speed_rad_per_s(0), 0);
}

class RotorFile : public testing::Test {
 protected:
  std::string refused() const {
    const std::string test = testing::UnitTest::GetInstance()->current_test_info()->name();
    const auto path = std::filesystem::path(testing::TempDir()) / ("rotor_file_" + test + ".json");
    std::ofstream(path) << json.dump();
    return error_of([&] { load_rotor(path); });
  }
  nlohmann::json json = read_json(rotor_file("crazyflie_bench"));
};

TEST_F(RotorFile, NegativeInertiaIsRefused) {
  json["inertia"]["value"] = -1e-8;
  EXPECT_THAT(refused(), AllOf(HasSubstr("rotor_file_NegativeInertiaIsRefused.json"),
                               HasSubstr("/inertia/value: -1e-08 must be > 0")));
}

TEST_F(RotorFile, MissingKeyIsRefused) {
  json.erase("torque_per_thrust");
  EXPECT_THAT(refused(), HasSubstr("the key 'torque_per_thrust' is missing"));
}

TEST_F(RotorFile, WrongUnitIsRefused) {
  json["reference_density"]["unit"] = "g/l";
  EXPECT_THAT(refused(), HasSubstr("/reference_density/unit: the unit \"g/l\" must be \"kg/m3\""));
}

TEST_F(RotorFile, SpeedThatDoesNotRiseIsRefused) {
  json["steady_speed"]["speed"]["value"][5] = 100;
  EXPECT_THAT(refused(), HasSubstr("/steady_speed/speed/value/5: 100 must be greater than the value before it"));
}

TEST_F(RotorFile, TableThatDoesNotBeginAtRestIsRefused) {
  json["steady_speed"]["effective_voltage"]["value"][0] = 0.1;
  EXPECT_THAT(refused(), HasSubstr("/steady_speed/effective_voltage/value/0: this must be 0, for standstill"));
}

TEST_F(RotorFile, EfficiencyAboveOneIsRefused) {
  json["propulsion_efficiency"]["value"] = 1.5;
  EXPECT_THAT(refused(), HasSubstr("/propulsion_efficiency/value: 1.5 must be > 0 and <= 1"));
}

TEST_F(RotorFile, RotorThatCannotSpeedUpIsRefused) {
  json["spin_up_linear"]["value"] = 0;
  EXPECT_THAT(refused(), HasSubstr("would never change its speed"));
}

TEST_F(RotorFile, MotorTogetherWithATableOfSpeedsIsRejected) {
  json["motor"] = read_json(rotor_file("crazyflie_legacy"))["motor"];
  EXPECT_THAT(refused(), AllOf(HasSubstr("/steady_speed: 'motor' already determines this"),
                               HasSubstr("remove 'power_per_thrust' or 'motor'")));
}

TEST_F(RotorFile, IntervalWithoutItsValueIsRefused) {
  json["inertia"]["interval"] = {1e-8, 2e-8};
  EXPECT_THAT(refused(), HasSubstr("/inertia/interval: the interval from 1e-08 to 2e-08 must contain the value"));
}

TEST_F(RotorFile, IntervalOfOneNumberIsRefused) {
  json["inertia"]["interval"] = {1e-8};
  EXPECT_THAT(refused(), HasSubstr("/inertia/interval: two numbers are needed"));
}

TEST(RotorCalibration, ThrustMovesWithoutSpeedTorqueAndPower) {
  Parameters most;
  most.rotor_data = "crazyflie_legacy";
  most.calibration_thrust = 1;
  Parameters as_stated = most;
  as_stated.calibration_thrust = 0;
  Stand moved(most);
  Stand still(as_stated);
  for (auto* stand : {&moved, &still}) {
    stand->command(0.6);
    stand->settle();
  }
  EXPECT_NEAR(moved.outputs.rotor_thrust_n[0] / still.outputs.rotor_thrust_n[0], 2.061 / 1.989, 1e-12);
  EXPECT_NEAR(moved.outputs.rotor_speed_rad_per_s[0], still.outputs.rotor_speed_rad_per_s[0], 1e-9);
  EXPECT_NEAR(moved.outputs.rotor_torque_n_m[0], still.outputs.rotor_torque_n_m[0], 1e-15);
  EXPECT_NEAR(moved.outputs.power_w, still.outputs.power_w, 1e-9);
}

TEST(RotorCalibration, PowerMovesAlone) {
  Parameters most;
  most.rotor_data = "crazyflie_legacy";
  most.calibration_power = -1;
  Parameters as_stated = most;
  as_stated.calibration_power = 0;
  Stand moved(most);
  Stand still(as_stated);
  for (auto* stand : {&moved, &still}) {
    stand->command(0.6);
    stand->settle();
  }
  EXPECT_EQ(moved.outputs.rotor_thrust_n, still.outputs.rotor_thrust_n);
  EXPECT_NEAR(moved.outputs.power_w / still.outputs.power_w, 0.955, 1e-12);
}

TEST(RotorCalibration, WarnsWhereTheFileHasNoInterval) {
  const auto rotor = load_rotor(rotor_file("crazyflie_bench"), {.thrust = 1, .power = 1});
  EXPECT_EQ(rotor.thrust_coefficient, bench_rotor().thrust_coefficient);
  ASSERT_EQ(rotor.warnings.size(), 2U);
  EXPECT_THAT(rotor.warnings[1], HasSubstr("calibration.thrust has no effect"));
}

TEST_F(RotorFile, UnknownNameListsTheKnownOnes) {
  Parameters wrong;
  wrong.rotor_data = "mavic";
  EXPECT_THAT(error_of([&] { Stand{wrong}; }),
              AllOf(HasSubstr("rotor_data = \"mavic\""), HasSubstr("'crazyflie_bench', 'crazyflie_l250'")));
}

}  // namespace
}  // namespace mebots::motors
