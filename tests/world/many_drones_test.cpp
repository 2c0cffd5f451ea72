// SPDX-License-Identifier: Apache-2.0
// Tests several drones in one world.
#include "dynamics/downwash.hpp"
#include "mebots/error.hpp"
#include "support/fleet.hpp"
#include "support/same_state.hpp"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <random>
#include <set>

namespace mebots::world {
namespace {

using test::Fleet;
using test::FlightRig;
using test::RigParameters;
using test::shipped_scene;
using testing::Contains;
using testing::HasSubstr;

/// Sets the set-points of a flight: take-off, forward, landing.
template <typename Input>
void script(Input& in, double t) {
  in.setpoint_mode = t < 4.0 ? FlightMode::take_off : t < 8.0 ? FlightMode::fly : FlightMode::land;
  in.setpoint_velocity_x_m_per_s = 0.5;
}

RigParameters together() {
  RigParameters p = FlightRig::small_camera();
  p.start_spacing_m = {};
  return p;
}

/// Compares the bits of both drones' outputs.
void expect_same(const DroneOutputs& a, const DroneOutputs& b) {
  EXPECT_EQ(a.drone_position_m, b.drone_position_m);
  EXPECT_EQ(a.drone_velocity_m_per_s, b.drone_velocity_m_per_s);
  EXPECT_EQ(a.drone_angular_velocity_rad_per_s, b.drone_angular_velocity_rad_per_s);
  EXPECT_EQ(a.rotor_command, b.rotor_command);
  EXPECT_EQ(a.range_down_m, b.range_down_m);
  EXPECT_EQ(a.drone_path_length_m, b.drone_path_length_m);
  EXPECT_EQ(a.drone_phase, b.drone_phase);
  EXPECT_EQ(a.gate_touched, b.gate_touched);
  EXPECT_EQ(a.gate_crossed, b.gate_crossed);
  EXPECT_EQ(a.gate_lateral_error_m, b.gate_lateral_error_m);
}

TEST(ManyDrones, DronesThatDoNotTouchHaveTheBitsOfWorldsOfTheirOwn) {
  const auto scene = shipped_scene("gate_easy");
  // The second drone touches the gate's frame.
  const std::vector<std::array<double, 3>> offsets{
      {0.0, 0.0, 0.0}, {3.0, 0.355, 0.0}, {0.0, 1.0, 0.0}, {1.0, -1.0, 0.0}};
  Fleet fleet(scene, together(), offsets);
  std::vector<std::unique_ptr<FlightRig>> alone;
  for (const auto& offset : offsets) {
    RigParameters p = together();
    p.start_offset_m = offset;
    alone.push_back(std::make_unique<FlightRig>(scene, p));
  }
  for (int i = 0; i < 9000; ++i) {
    for (auto& drone : fleet.drones) script(drone.inputs, fleet.time_s());
    for (auto& rig : alone) script(rig->inputs, rig->time_s());
    fleet.step();
    for (auto& rig : alone) rig->step();
  }
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    SCOPED_TRACE(i);
    expect_same(fleet.drones[i].outputs, alone[i]->outputs);
  }
  EXPECT_TRUE(alone[1]->outputs.gate_touched);
  EXPECT_TRUE(alone[0]->outputs.drone_landed);
  std::vector<std::string> expected;
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    for (const auto& event : alone[i]->events) expected.push_back(fmt::format("drone[{}]: {}", i + 1, event));
  }
  EXPECT_THAT(fleet.events, testing::UnorderedElementsAreArray(expected));
}

TEST(ManyDrones, TheFirstDroneHasTheNoiseOfADroneAloneAndTheOthersTheirOwn) {
  RigParameters p = together();
  p.range_noise_m = 0.01;
  p.imu_rate_noise_rad_per_s = 0.01;
  FlightRig alone(shipped_scene("empty"), p);
  Fleet fleet(shipped_scene("empty"), p, {{0.0, 0.0, 0.0}, {0.0, 2.0, 0.0}, {0.0, 4.0, 0.0}});
  alone.step(100'000'000);
  fleet.step(100'000'000);
  EXPECT_EQ(fleet.drones[0].outputs.range_down_m, alone.outputs.range_down_m);
  EXPECT_EQ(fleet.drones[0].outputs.imu_angular_velocity_rad_per_s, alone.outputs.imu_angular_velocity_rad_per_s);
  std::set<double> rates;
  for (const auto& drone : fleet.drones) rates.insert(drone.outputs.imu_angular_velocity_rad_per_s[0]);
  EXPECT_EQ(rates.size(), 3U);
}

TEST(ManyDrones, BothReportACollision) {
  Fleet fleet(shipped_scene("empty"), together(), {{0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}});
  for (int i = 0; i < 500; ++i) fleet.step();
  EXPECT_TRUE(fleet.drones[0].outputs.drone_crashed);
  EXPECT_TRUE(fleet.drones[1].outputs.drone_crashed);
  // With drag c = 0.0128 N.s/m and m = 0.04 kg, tau = m / c. v = g tau (1 - exp(-t / tau)) = 4.163 m/s at 0.456 s.
  EXPECT_THAT(fleet.events, Contains(testing::MatchesRegex("drone\\[1\\].*crash: hit drone\\[2\\] with 4\\.16.*")));
  EXPECT_THAT(fleet.events, Contains(testing::MatchesRegex("drone\\[2\\].*crash: hit drone\\[1\\] with 4\\.16.*")));
}

TEST(ManyDrones, ACollisionKeepsTheMomentumAndHasTheScenesBounce) {
  auto scene = shipped_scene("empty");
  const std::array sizes{scene.drone.body_size_m, scene.drone.body_size_m};
  RigidWorld bodies(scene, sizes);
  std::array<RigidState, 2> states;
  for (std::size_t i = 0; i < 2; ++i) {
    bodies.set_mass(i, 0.03, inertia_for(scene.drone, 0.03));
    states[i].p_WB_m = {i == 0 ? -0.1 : 0.1, 0.0, 1000.0};
    states[i].v_WB_m_per_s = {i == 0 ? 0.6 : -0.2, 0.0, 0.0};
  }
  for (int step = 0; step < 300; ++step) {
    for (std::size_t i = 0; i < 2; ++i) bodies.place(i, states[i]);
    bodies.step(1e-3, 0);
    for (std::size_t i = 0; i < 2; ++i) states[i] = bodies.state(i);
  }
  const double a = states[0].v_WB_m_per_s.x();
  const double b = states[1].v_WB_m_per_s.x();
  EXPECT_NEAR(a + b, 0.4, 1e-12);
  // Soft contacts increase the bounce of 0.5 a little.
  EXPECT_NEAR((b - a) / 0.8, scene.contact.bounce, 0.02);
}

TEST(ManyDrones, TheBroadPhaseFindsThePairsThatTestingAllFinds) {
  const auto scene = shipped_scene("empty");
  constexpr std::size_t kCount = 60;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(0.0, 0.5);
  std::vector<RigidState> states(kCount);
  for (auto& state : states) state.p_WB_m = {place(random), place(random), 1.0 + place(random)};
  RigidWorld all(scene, std::vector<Eigen::Vector3d>(kCount, scene.drone.body_size_m));
  RigidWorld pair(scene, std::vector<Eigen::Vector3d>(2, scene.drone.body_size_m));
  for (std::size_t i = 0; i < kCount; ++i) all.place(i, states[i]);
  all.find_touches(0);
  std::size_t found = 0;
  for (std::size_t i = 0; i < kCount; ++i) {
    std::set<std::size_t> expected;
    std::set<std::size_t> touched;
    for (const auto& touch : all.touches(i)) touched.insert(touch.index);
    for (std::size_t k = 0; k < kCount; ++k) {
      if (k == i) continue;
      pair.place(0, states[i]);
      pair.place(1, states[k]);
      pair.find_touches(0);
      if (!pair.touches(0).empty()) expected.insert(k);
    }
    EXPECT_EQ(touched, expected) << i;
    found += touched.size();
  }
  EXPECT_GT(found, 20U);
}

TEST(ManyDrones, DownwashIsThatOfGymPybulletDrones) {
  // F = 2267.18 (r / 4 dz)^2 exp(-(dxy / (0.16 dz - 0.11))^2 / 2), by hand.
  EXPECT_NEAR(downwash({0.0, 0.0, 1.0}, 0.0231348), 0.0758399, 1e-6);
  EXPECT_NEAR(downwash({0.03, 0.04, 1.0}, 0.0231348), 0.0758399 * std::exp(-0.5), 1e-6);
  EXPECT_NEAR(downwash({0.0, 0.0, 2.0}, 0.0231348), 0.0758399 / 4.0, 1e-6);
  EXPECT_EQ(downwash({0.0, 0.0, -1.0}, 0.0231348), 0.0);
  EXPECT_EQ(downwash({0.0, 10.0, 100.0}, 0.0231348), 0.0);
  for (const double dz_m : {1e-6, 1e-3, 0.1, 0.6874}) {  // where the formula is not valid
    EXPECT_EQ(downwash({0.0, 0.5, dz_m}, 0.0231348), 0.0);
    EXPECT_EQ(downwash({0.0, 0.0, dz_m}, 0.0231348), 0.0);
  }
}

TEST(ManyDrones, DownwashPushesTheLowerDroneAlone) {
  const auto fall = [](double strength) {
    RigParameters p = together();
    p.downwash_strength = strength;
    Fleet fleet(shipped_scene("empty"), p, {{0.0, 0.0, 5.0}, {0.05, 0.0, 6.0}});
    fleet.step(1'000'000);
    return std::array{fleet.drones[0].outputs.drone_velocity_m_per_s[2],
                      fleet.drones[1].outputs.drone_velocity_m_per_s[2], fleet.drones[0].outputs.drone_mass_kg};
  };
  const auto without = fall(0.0);
  const auto with = fall(1.0);
  const double force_n = downwash({0.05, 0.0, 1.0}, DroneParameters().rotors_radius_m);
  EXPECT_NEAR(without[0] - with[0], 1e-3 * force_n / with[2], 1e-12);
  EXPECT_EQ(without[1], with[1]);
}

TEST(ManyDrones, TheRangeSensorSeesADroneBelow) {
  Fleet fleet(shipped_scene("empty"), together(), {{0.0, 0.0, 1.0}, {0.0, 0.0, 1.5}});
  const double half_height_m = 0.5 * shipped_scene("empty").drone.body_size_m.z();
  EXPECT_NEAR(fleet.drones[1].outputs.range_down_m, 0.5 - half_height_m, 1e-12);
  const double height_m = fleet.drones[0].outputs.drone_position_m[2];
  EXPECT_NEAR(fleet.drones[0].outputs.range_down_m, height_m, 1e-12);
}

std::vector<std::uint8_t> picture_of(const DroneOutputs& outputs) {
  const auto bytes = outputs.camera_frame.bytes();
  return {bytes.begin(), bytes.end()};
}

TEST(ManyDrones, ACameraShowsTheDroneAheadAndNotItsOwn) {
  constexpr int kSize = 160;
  RigParameters p = together();
  p.camera_width = kSize;
  p.camera_height = kSize;
  p.camera_noise = 0.0;
  const auto pictures = [&](const std::array<double, 3>& second) {
    Fleet fleet(shipped_scene("empty"), p, {{0.0, 0.0, 1.0}, second});
    for (auto& drone : fleet.drones) drone.inputs.camera_trigger = 1;
    fleet.step();
    return std::array{picture_of(fleet.drones[0].outputs), picture_of(fleet.drones[1].outputs)};
  };
  const auto alone = [&](const std::array<double, 3>& offset) {
    RigParameters own = p;
    own.start_offset_m = offset;
    FlightRig rig(shipped_scene("empty"), own);
    rig.inputs.camera_trigger = 1;
    rig.step();
    return picture_of(rig.outputs);
  };
  const auto seen = pictures({0.5, 0.0, 1.0});
  const auto empty = pictures({0.5, 9.0, 1.0});
  EXPECT_EQ(empty[0], alone({0.0, 0.0, 1.0}));
  EXPECT_EQ(seen[1], alone({0.5, 0.0, 1.0}));
  // The front of the box is 0.5 - 0.046 - 0.027 m ahead of the camera and 0.092 m wide. Its lower edge is 0.0265 m
  // below the camera.
  const double pixels_per_m = 0.5 * kSize / std::tan(0.5 * p.camera_field_of_view_rad) / 0.427;
  std::set<int> columns;
  int lowest = 0;
  for (int i = 0; i < kSize * kSize; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (seen[0][at] == empty[0][at]) continue;
    lowest = std::max(lowest, i / kSize);
    if (i / kSize == kSize / 2 + 2) columns.insert(i % kSize);
  }
  EXPECT_NEAR(static_cast<double>(columns.size()), 0.092 * pixels_per_m, 1.0);
  EXPECT_NEAR(lowest + 1, kSize / 2 + 0.0265 * pixels_per_m, 1.0);
}

TEST(ManyDrones, SpacingSetsTheStarts) {
  RigParameters p = FlightRig::small_camera();
  p.start_spacing_m = {0.0, 0.5, 0.0};
  const Fleet fleet(shipped_scene("empty"), p, {{}, {}, {0.25, 0.0, 0.0}});
  const auto first = fleet.drones[0].outputs.drone_position_m;
  EXPECT_EQ(fleet.drones[1].outputs.drone_position_m[1], first[1] + 0.5);
  EXPECT_EQ(fleet.drones[2].outputs.drone_position_m[1], first[1] + 1.0);
  EXPECT_EQ(fleet.drones[2].outputs.drone_position_m[0], first[0] + 0.25);
}

TEST(ManyDrones, ErrorsNameTheDrone) {
  const auto error_of = [](auto act) -> std::string {
    try {
      act();
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_THAT(error_of([] {
                Fleet(shipped_scene("empty"), together(), {{}, {0.01, 0.0, 0.0}});
              }),
              testing::AllOf(HasSubstr("drone[1]: "), HasSubstr("deep in drone[2]"), HasSubstr("start.spacing")));
  EXPECT_THAT(error_of([] {
                Fleet fleet(shipped_scene("empty"), together(), {{}, {1.0, 0.0, 0.0}});
                fleet.drones[1].inputs.cell_mass_kg = -1.0;
                fleet.step();
              }),
              testing::StartsWith("drone[2]: cell.mass = -1"));
}

TEST(ManyDrones, ARestoredWorldContinuesWithTheSameBitsDuringContact) {
  // The second drone falls onto the first drone, and then rests on it or next to it.
  const auto make = [] {
    return std::make_unique<Fleet>(shipped_scene("empty"), together(),
                                   std::vector<std::array<double, 3>>{{}, {0.01, 0.02, 0.05}, {0.0, 0.5, 0.0}});
  };
  auto straight = make();
  std::vector<std::unique_ptr<Fleet>> restored;
  for (const int cut : {30, 60, 200}) {
    while (straight->time_ns < cut * 2'000'000) straight->step();
    auto& other = *restored.emplace_back(make());
    for (std::size_t i = 0; i < other.drones.size(); ++i) {
      other.drones[i].inputs = straight->drones[i].inputs;
      other.drones[i].outputs = straight->drones[i].outputs;
      other.drones[i].outputs.camera_frame = {};
    }
    other.rotors = straight->rotors;
    other.time_ns = straight->time_ns;
    state::restore(other.world, state::save(straight->world));
    while (other.time_ns < 1'000'000'000) other.step();
  }
  while (straight->time_ns < 1'000'000'000) straight->step();
  for (const auto& other : restored) EXPECT_TRUE(mebots::test::same_state(straight->world, other->world));
}

TEST(ManyDrones, AStateOfAnotherNumberIsRefused) {
  Fleet two(shipped_scene("empty"), together(), {{}, {1.0, 0.0, 0.0}});
  Fleet three(shipped_scene("empty"), together(), {{}, {1.0, 0.0, 0.0}, {2.0, 0.0, 0.0}});
  EXPECT_THROW(state::restore(three.world, state::save(two.world)), Error);
  EXPECT_THROW(state::restore(two.world, state::save(three.world)), Error);
}

TEST(ManyDrones, TheViewHasABodyForEach) {
  Fleet fleet(shipped_scene("empty"), together(), {{}, {1.0, 0.0, 0.0}});
  const auto view = nlohmann::json::parse(fleet.world.view());
  ASSERT_EQ(view["bodies"].size(), 2U);
  EXPECT_EQ(view["bodies"][1]["position"][0], "drone[2].position.x");
  EXPECT_EQ(view["bodies"][1]["rotors"][3]["command"], "drone[2].rotor[4].command");
}

}  // namespace
}  // namespace mebots::world
