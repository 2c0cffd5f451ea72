// SPDX-License-Identifier: Apache-2.0
//
// Tests a drone that descends to the ground without a landing: its phase, its event and its outputs.
#include "flight/ground_contact.hpp"
#include "support/flight_rig.hpp"

#include <gmock/gmock.h>

#include <cmath>

namespace mebots::world {
namespace {

using test::FlightRig;
using test::shipped_scene;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

constexpr std::int64_t kMs = 1'000'000;
constexpr double kGravity_m_per_s2 = 9.80665;
constexpr double kCarriedMass_kg = 0.04;

constexpr double kHeight_m = 0.0145;

/// Records a touch in every millisecond of [from, to).
void touch(GroundContact& contact, std::int64_t from_ms, std::int64_t to_ms) {
  for (auto ms = from_ms; ms < to_ms; ++ms) contact.update(true, kHeight_m, ms * kMs);
}

TEST(GroundContact, CountsAfterItsHoldTimeOnly) {
  GroundContact contact(false, 1.0, 0, 1000 * kMs);
  touch(contact, 100, 1100);
  EXPECT_FALSE(contact.has_landed());
  touch(contact, 1100, 1101);
  EXPECT_TRUE(contact.has_landed());
  EXPECT_EQ(contact.since_ns(), 100 * kMs);
}

TEST(GroundContact, ContinuesOverLowHopsAndEndsWithHigherOnes) {
  GroundContact low(false, 1.0, 0, 1000 * kMs);
  low.update(true, kHeight_m, 100 * kMs);
  low.update(false, kHeight_m + 0.09, 1100 * kMs);
  EXPECT_FALSE(low.has_landed()) << "not before it touches again";
  low.update(true, kHeight_m, 2100 * kMs);
  EXPECT_TRUE(low.has_landed());
  EXPECT_EQ(low.since_ns(), 100 * kMs);
  GroundContact high(false, 1.0, 0, 1000 * kMs);
  for (int ms = 0; ms <= 6000; ms += 600) {
    high.update(true, kHeight_m, ms * kMs);
    high.update(false, kHeight_m + 0.11, (ms + 300) * kMs);
  }
  EXPECT_FALSE(high.has_landed()) << "touches and goes";
  GroundContact hovering(false, 1.0, 0, 1000 * kMs);
  hovering.update(true, kHeight_m, 0);
  hovering.update(false, kHeight_m + 0.05, 5001 * kMs);
  hovering.update(true, kHeight_m, 5002 * kMs);
  EXPECT_FALSE(hovering.has_landed()) << "flew at 5 cm for 5 s";
}

TEST(GroundContact, IsNoDescentForADroneThatWasOnTheGround) {
  GroundContact contact(true, kHeight_m, 0, 1000 * kMs);
  touch(contact, 0, 5000);
  EXPECT_FALSE(contact.has_landed());
  contact.update(false, 1.0, 6000 * kMs);
  touch(contact, 7000, 9000);
  EXPECT_TRUE(contact.has_landed());
  contact.stand();
  EXPECT_FALSE(contact.has_landed()) << "it has landed";
}

/// After a fall from this height, bounces are below 10 cm.
constexpr double kFall_m = 0.3;

/// A low flight in still air without drag. From t = 0 on, the thrust is `share` of the weight.
struct WeakFlight {
  static scene::Scene scene() {
    auto made = shipped_scene("empty");
    made.drone.drag_n_s_per_m.setZero();
    return made;
  }
  static test::RigParameters parameters() {
    auto made = FlightRig::small_camera();
    made.start_offset_m = {0, 0, kFall_m};
    return made;
  }

  WeakFlight() : rig(scene(), parameters()) {
    carry(1.0);
    rig.inputs.setpoint_mode = FlightMode::fly;
  }
  void carry(double share) { rig.rotors.thrust_n.fill(0.25 * share * kCarriedMass_kg * kGravity_m_per_s2); }
  void run(double seconds, double share) {
    carry(share);
    rig.run(seconds, [this, share] { carry(share); });
  }

  FlightRig rig;
};

TEST(SinkingFlight, IsGroundedFromTheTimeThatThrustAndWeightGive) {
  constexpr double kShare = 0.97;
  WeakFlight flight;
  auto& rig = flight.rig;
  const double height_m = rig.altitude_m() - 0.0145;
  flight.run(6.0, kShare);
  const double fall_s = std::sqrt(2 * height_m / ((1 - kShare) * kGravity_m_per_s2));
  EXPECT_EQ(rig.outputs.drone_phase, FlightPhase::grounded);
  EXPECT_TRUE(rig.outputs.drone_grounded);
  EXPECT_NEAR(rig.outputs.drone_grounded_time_s, fall_s, 0.01);
  EXPECT_FALSE(rig.outputs.drone_landed);
  EXPECT_FALSE(rig.outputs.drone_crashed);
  EXPECT_NEAR(rig.altitude_m(), 0.0145, 1e-3);
  EXPECT_THAT(rig.events, Contains(HasSubstr("on the ground since t = ")));
  for (const double command : rig.outputs.rotor_command) EXPECT_GT(command, 0.0) << "the motors are on";
}

TEST(SinkingFlight, FliesAgainWithThrustAndKeepsTheNote) {
  WeakFlight flight;
  flight.run(6.0, 0.97);
  ASSERT_EQ(flight.rig.outputs.drone_phase, FlightPhase::grounded);
  const double came_down_s = flight.rig.outputs.drone_grounded_time_s;
  flight.run(2.0, 1.02);
  EXPECT_EQ(flight.rig.outputs.drone_phase, FlightPhase::flying);
  EXPECT_TRUE(flight.rig.outputs.drone_grounded);
  EXPECT_EQ(flight.rig.outputs.drone_grounded_time_s, came_down_s);
}

TEST(SinkingFlight, HasLandedIfItWasCommandedToLand) {
  WeakFlight flight;
  flight.run(6.0, 0.97);
  flight.rig.inputs.setpoint_mode = FlightMode::land;
  flight.run(1.0, 0.5);
  EXPECT_EQ(flight.rig.outputs.drone_phase, FlightPhase::landed);
}

TEST(SinkingFlight, IsNotDetectedForATouchAndGo) {
  WeakFlight flight;
  flight.run(std::sqrt(2 * kFall_m / (0.03 * kGravity_m_per_s2)) + 0.3, 0.97);
  flight.run(2.0, 1.05);
  EXPECT_EQ(flight.rig.outputs.drone_phase, FlightPhase::flying);
  EXPECT_FALSE(flight.rig.outputs.drone_grounded);
  EXPECT_THAT(flight.rig.events, Not(Contains(HasSubstr("on the ground since"))));
}

TEST(SinkingFlight, ATakeOffThatNeverLeavesTheGroundIsClimbing) {
  FlightRig rig(WeakFlight::scene());
  rig.inputs.setpoint_mode = FlightMode::take_off;
  rig.rotors.sag = 0.2;
  rig.run(5.0);
  EXPECT_EQ(rig.outputs.drone_phase, FlightPhase::climbing);
  EXPECT_FALSE(rig.outputs.drone_grounded);
}

}  // namespace
}  // namespace mebots::world
