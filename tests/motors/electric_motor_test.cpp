// SPDX-License-Identifier: Apache-2.0
#include "electric_motor.hpp"

#include "support.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace mebots::motors {
namespace {

RotorData legacy_rotor() {
  return load_rotor(rotor_file("crazyflie_legacy"));
}

RotorDrive drive_at(const RotorData& rotor, double duty, double supply_v) {
  RotorDrive drive;
  drive.duty = duty;
  drive.voltage_v = duty * supply_v;
  drive.driven = drive.voltage_v > 0;
  drive.thrust_coefficient = rotor.thrust_coefficient;
  drive.steady_speed_rad_per_s = steady_speed_rad_per_s(rotor, rotor.thrust_coefficient, drive.voltage_v);
  return drive;
}

double drag_torque(const RotorData& rotor, double speed) {
  return rotor.torque_per_thrust_m * rotor.thrust_coefficient * speed * speed;
}

double current_a(const RotorData& rotor, const RotorDrive& drive, double speed) {
  const ElectricMotor& motor = *rotor.motor;
  return std::max(0.0, (drive.voltage_v - motor.back_emf_vs_per_rad * speed) / motor.resistance_ohm);
}

double ripple_w(const RotorData& rotor, const RotorDrive& drive) {
  return rotor.motor->ripple_conductance_s * std::pow(drive.voltage_v * (1 - drive.duty), 2);
}

/// The solution of the motor's equations by the Runge-Kutta method of order 4: speed, copper loss and shaft work.
struct Reference {
  double speed = 0;
  double copper_j = 0;
  double shaft_j = 0;
};
Reference reference(const RotorData& rotor, const RotorDrive& drive, double initial, double duration_s, int steps) {
  using State = std::array<double, 3>;
  const auto rate = [&](const State& y) {
    const double i = current_a(rotor, drive, y[0]);
    const double torque = rotor.motor->back_emf_vs_per_rad * i;
    return State{(torque - drag_torque(rotor, y[0])) / rotor.inertia_kg_m2, rotor.motor->resistance_ohm * i * i,
                 torque * y[0]};
  };
  const auto moved = [](const State& y, const State& f, double h) {
    return State{y[0] + h * f[0], y[1] + h * f[1], y[2] + h * f[2]};
  };
  State y{initial, 0, 0};
  const double h = duration_s / steps;
  for (int n = 0; n < steps; ++n) {
    const State a = rate(y);
    const State b = rate(moved(y, a, h / 2));
    const State c = rate(moved(y, b, h / 2));
    const State d = rate(moved(y, c, h));
    for (std::size_t k = 0; k < y.size(); ++k) y[k] += h / 6 * (a[k] + 2 * b[k] + 2 * c[k] + d[k]);
  }
  return {y[0], y[1], y[2]};
}

TEST(ElectricMotor, SteadySpeedBalancesMotorAndDragTorque) {
  const RotorData rotor = legacy_rotor();
  for (const double voltage : {0.0, 0.01, 1.0, 2.4, 4.2}) {
    const RotorDrive drive = drive_at(rotor, 1, voltage);
    const double u = drive.steady_speed_rad_per_s;
    EXPECT_NEAR(rotor.motor->back_emf_vs_per_rad * current_a(rotor, drive, u), drag_torque(rotor, u),
                1e-12 * drag_torque(rotor, u) + 1e-18);
  }
}

TEST(ElectricMotor, EnergyIsCopperLossShaftWorkAndRipple) {
  const RotorData rotor = legacy_rotor();
  for (const auto& [initial, duty] :
       {std::pair{0.0, 0.7}, {1900.0, 0.72}, {2100.0, 0.65}, {2400.0, 0.3}, {2400.0, 0.1}}) {
    const RotorDrive drive = drive_at(rotor, duty, 3.6);
    const RotorStep step = advance_motor(rotor, drive, initial, 0.3);
    const Reference sum = reference(rotor, drive, initial, 0.3, 200'000);
    const double expected_j = sum.copper_j + sum.shaft_j + 0.3 * ripple_w(rotor, drive);
    // With steps of 1.5 us, the error of the reference has order 4, but order 2 in the step in which the current
    // begins.
    EXPECT_NEAR(step.speed_rad_per_s, sum.speed, 1e-7 * sum.speed) << initial << " at " << duty;
    EXPECT_NEAR(step.energy_j, expected_j, 1e-7 * expected_j) << initial << " at " << duty;
  }
}

TEST(ElectricMotor, ShaftWorkIsDragAndKineticEnergy) {
  const RotorData rotor = legacy_rotor();
  const RotorDrive drive = drive_at(rotor, 0.7, 3.6);
  const Reference sum = reference(rotor, drive, 400, 0.2, 20'000);
  double drag_j = 0;
  double speed = 400;
  constexpr int kPieces = 20'000;
  for (int n = 0; n < kPieces; ++n) {
    const double next = advance_motor(rotor, drive, speed, 0.2 / kPieces).speed_rad_per_s;
    const double middle = (speed + next) / 2;
    drag_j += drag_torque(rotor, middle) * middle * 0.2 / kPieces;
    speed = next;
  }
  const double kinetic_j = 0.5 * rotor.inertia_kg_m2 * (speed * speed - 400 * 400);
  EXPECT_NEAR(sum.shaft_j, drag_j + kinetic_j, 1e-7 * sum.shaft_j);  // the sum has steps of 10 us
}

TEST(ElectricMotor, RungeKuttaConvergesToTheClosedFormWithOrderFour) {
  const RotorData rotor = legacy_rotor();
  const RotorDrive drive = drive_at(rotor, 0.7, 3.6);
  const double exact = advance_motor(rotor, drive, 500, 0.2).speed_rad_per_s;
  const double coarse = std::abs(reference(rotor, drive, 500, 0.2, 8).speed - exact);
  const double fine = std::abs(reference(rotor, drive, 500, 0.2, 16).speed - exact);
  EXPECT_GT(coarse / fine, 13);
  EXPECT_LT(coarse / fine, 22);
}

TEST(ElectricMotor, ResultDoesNotDependOnTheStep) {
  const RotorData rotor = legacy_rotor();
  for (const double duty : {0.7, 0.2, 0.0}) {
    const RotorDrive drive = drive_at(rotor, duty, 3.6);
    const RotorStep once = advance_motor(rotor, drive, 2300, 0.4);
    double speed = 2300;
    double energy_j = 0;
    for (int i = 0; i < 200; ++i) {
      const RotorStep step = advance_motor(rotor, drive, speed, 0.002);
      speed = step.speed_rad_per_s;
      energy_j += step.energy_j;
    }
    EXPECT_NEAR(speed, once.speed_rad_per_s, 1e-10 * speed);  // rounding errors of 200 steps
    EXPECT_NEAR(energy_j, once.energy_j, 1e-9 * energy_j) << duty;
  }
}

TEST(ElectricMotor, DiodeBlocksBrakingCurrent) {
  // If the voltage is far below the back EMF, the rotor slows down as if the motor were switched off.
  const RotorData rotor = legacy_rotor();
  const RotorStep idle = advance_motor(rotor, drive_at(rotor, 0.1, 3.6), 2000, 0.01);
  const RotorStep off = advance_motor(rotor, drive_at(rotor, 0, 3.6), 2000, 0.01);
  EXPECT_EQ(idle.speed_rad_per_s, off.speed_rad_per_s);
  EXPECT_EQ(off.energy_j, 0);
}

TEST(ElectricMotor, ThinnerAirSpinsFasterAtTheSameVoltage) {
  const RotorData rotor = legacy_rotor();
  EXPECT_GT(steady_speed_rad_per_s(rotor, rotor.thrust_coefficient_at(0.9), 2.4),
            steady_speed_rad_per_s(rotor, rotor.thrust_coefficient_at(1.225), 2.4));
}

TEST(ElectricMotor, ModelDeliversItsPowerToTheBus) {
  Parameters parameters;
  parameters.rotor_data = "crazyflie_legacy";
  Stand stand(parameters);
  stand.inputs.bus_voltage_v = 3.6;
  stand.command(0.68);
  stand.settle();
  const RotorData rotor = legacy_rotor();
  const RotorDrive drive = drive_at(rotor, 0.68, 3.6);
  const double u = drive.steady_speed_rad_per_s;
  EXPECT_NEAR(stand.outputs.rotor_speed_rad_per_s[0], u, 1e-9 * u);
  const double expected_w = drive.voltage_v * current_a(rotor, drive, u) + ripple_w(rotor, drive);
  EXPECT_NEAR(stand.outputs.power_w, 4 * expected_w, 1e-9 * expected_w);
}

/// Four motors on a source of 4.1 V and 0.16 Ohm. Motors and source step at the same time (Jacobi algorithm), so each
/// uses the other's output from before the step.
struct Supplied {
  explicit Supplied(double bus_resistance_ohm) : stand(chosen(bus_resistance_ohm)) {
    stand.inputs.bus_voltage_v = kSource_v;
    stand.command(0.62);
  }
  static Parameters chosen(double bus_resistance_ohm) {
    Parameters parameters;
    parameters.rotor_data = "crazyflie_legacy";
    parameters.bus_resistance_ohm = bus_resistance_ohm;
    return parameters;
  }
  void step() {
    const double power_w = stand.outputs.power_w;
    stand.step(2 * kMillisecond);
    greatest_w = std::max(greatest_w, stand.outputs.power_w);
    const double root = kSource_v * kSource_v - 4 * kSource_ohm * power_w;
    stand.inputs.bus_voltage_v = (kSource_v + std::sqrt(std::max(root, 0.0))) / 2;
    least_v = std::min(least_v, stand.inputs.bus_voltage_v);
  }
  static constexpr double kSource_v = 4.1;
  static constexpr double kSource_ohm = 0.16;
  Stand stand;
  double greatest_w = 0;
  double least_v = kSource_v;
};

TEST(ElectricMotor, BusResistanceTakesTheSurgeOfTheFirstStepOff) {
  Supplied held(0);
  Supplied sagging(Supplied::kSource_ohm);
  for (int i = 0; i < 3000; ++i) {
    held.step();
    sagging.step();
  }
  // At standstill, four motors have a conductance of 1.46 S, so the voltage is 3.32 V. The power is 17.5 W, including
  // the loss due to the current ripple. At a constant 4.1 V, the power would be 26.5 W.
  EXPECT_GT(held.greatest_w, 25);
  EXPECT_LT(held.least_v, 2.8);
  EXPECT_NEAR(sagging.greatest_w, 17.5, 0.5);
  EXPECT_GT(sagging.least_v, 3.2);
  EXPECT_NEAR(sagging.stand.inputs.bus_voltage_v, held.stand.inputs.bus_voltage_v, 1e-9);
  EXPECT_NEAR(sagging.stand.outputs.power_w, held.stand.outputs.power_w, 1e-8);
}

TEST(ElectricMotor, RestoredRunWithBusResistanceContinuesWithTheSameBits) {
  Supplied straight(0.16);
  for (int i = 0; i < 20; ++i) straight.step();
  Supplied first(0.16);
  for (int i = 0; i < 10; ++i) first.step();
  Supplied second(0.16);
  state::restore(second.stand.model, state::save(first.stand.model));
  second.stand.inputs = first.stand.inputs;
  second.stand.outputs = first.stand.outputs;
  for (int i = 0; i < 10; ++i) second.step();
  EXPECT_EQ(state::first_difference(straight.stand.model, second.stand.model), std::nullopt);
}

/// Starts four motors on a cell of 0.15 Ohm, whose voltage depends on the current `steps` steps earlier.
std::vector<std::string> warnings_with_delay(std::size_t steps) {
  Parameters parameters;
  parameters.rotor_data = "crazyflie_legacy";
  parameters.bus_resistance_ohm = 0.15;
  std::vector<std::string> warnings;
  Model model(parameters, kParams, [&](std::string_view text) { warnings.emplace_back(text); });
  Inputs inputs;
  Outputs outputs;
  std::vector<double> current_a(steps, 0.0);
  for (int k = 0; k < 500; ++k) {
    inputs.rotor_command.fill(k < 10 ? 0 : 0.6);
    inputs.bus_voltage_v = 4.1 - 0.15 * current_a[current_a.size() - steps];
    model.step(inputs, 2 * kMillisecond, outputs);
    current_a.push_back(outputs.power_w / inputs.bus_voltage_v);
  }
  return warnings;
}

TEST(BusResistance, WarnsWhereTheVoltageContainsTheLastStepsCurrentAlready) {
  EXPECT_TRUE(warnings_with_delay(2).empty()) << "jacobi";
  const auto warnings = warnings_with_delay(1);  // gauss-seidel
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_THAT(warnings.front(), testing::HasSubstr("bus.resistance = 0.15 Ohm counts twice"));
}

}  // namespace
}  // namespace mebots::motors
