// SPDX-License-Identifier: Apache-2.0
// Tests networks that predict downwash. tests/system/downwash_test.py compares large networks with NumPy.
#include "dynamics/neural_downwash.hpp"

#include "mebots/error.hpp"
#include "support/fleet.hpp"
#include "support/same_state.hpp"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

namespace mebots::world {
namespace {

using nlohmann::json;
using scene::DownwashNetworks;
using testing::AllOf;
using testing::HasSubstr;

/// The first output of phi is x + 2 y + 3 z + 4 vx + 5 vy + 6 vz, and that of phi_ground is minus the height. rho uses
/// only their sum, with a ReLU: f = 1 mN * (0.5 + max(sum, 0)).
DownwashNetworks small_networks() {
  DownwashNetworks networks;
  networks.force_per_output_n = 1e-3;
  networks.phi = {{6, 2, {1.0, 0.0, 2.0, 0.0, 3.0, 0.0, 4.0, 0.0, 5.0, 0.0, 6.0, 0.0}, {0.0, -1.0}}};
  networks.phi_ground = {{4, 2, {1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0}, {0.0, 0.0}}};
  networks.rho = {{2, 1, {1.0, 0.0}, {0.0}}, {1, 1, {1.0}, {0.5}}};
  return networks;
}

RigidState state_of(const Eigen::Vector3d& p_m, const Eigen::Vector3d& v_m_per_s = Eigen::Vector3d::Zero()) {
  RigidState state;
  state.p_WB_m = p_m;
  state.v_WB_m_per_s = v_m_per_s;
  return state;
}

double force_n(const DownwashNetworks& networks, const RigidState& self, const std::vector<RigidState>& others) {
  NeuralDownwash downwash(networks);
  downwash.begin(self);
  for (const auto& other : others) downwash.add(other);
  return downwash.force_W_n();
}

TEST(NeuralDownwash, IsTheForcePerOutputTimesRhoOfTheSumOfFeatures) {
  auto networks = small_networks();
  networks.include_alone = true;
  const auto self = state_of({0.0, 0.0, 1.0}, {0.1, 0.0, 0.0});
  const auto first = state_of({1.0, 0.0, 2.0}, {0.1, 1.0, 0.0});   // phi is 1 + 3 + 5 = 9
  const auto second = state_of({0.0, 1.0, 1.0}, {0.1, 0.0, 1.0});  // phi is 2 + 6 = 8
  EXPECT_NEAR(force_n(networks, self, {first, second}), 1e-3 * (0.5 + 9.0 + 8.0 - 1.0), 1e-15);
  EXPECT_NEAR(force_n(networks, self, {}), 1e-3 * 0.5, 1e-15);  // max(-1, 0) is 0
}

TEST(NeuralDownwash, TheForceOnADroneAloneIsSubtracted) {
  const auto self = state_of({0.0, 0.0, -1.0});
  EXPECT_EQ(force_n(small_networks(), self, {}), 0.0);
  EXPECT_NEAR(force_n(small_networks(), self, {state_of({0.0, 0.0, 1.0})}), 1e-3 * 6.0, 1e-15);
}

TEST(NeuralDownwash, ADroneOutsideOfALimitIsNoNeighbour) {
  const auto self = state_of({0.0, 0.0, -1.0});
  for (std::size_t i = 0; i < 6; ++i) {
    auto networks = small_networks();
    networks.neighbour_limits[i] = 0.5;
    for (const double sign : {-1.0, 1.0}) {
      auto inside = self;
      (i < 3 ? inside.p_WB_m[static_cast<int>(i)] : inside.v_WB_m_per_s[static_cast<int>(i) - 3]) += sign * 0.4375;
      auto outside = self;
      (i < 3 ? outside.p_WB_m[static_cast<int>(i)] : outside.v_WB_m_per_s[static_cast<int>(i) - 3]) += sign * 0.5;
      EXPECT_NE(force_n(networks, self, {inside}), 0.0) << i;
      EXPECT_EQ(force_n(networks, self, {outside}), 0.0) << i;
    }
  }
}

TEST(NeuralDownwash, TheHeightIsHeldAtItsLimit) {
  auto networks = small_networks();
  networks.include_alone = true;
  networks.rho[0].offsets[0] = 10.0;
  networks.height_limit_m = 2.0;
  EXPECT_NEAR(force_n(networks, state_of({0.0, 0.0, 1.5}), {}), 1e-3 * 9.0, 1e-15);
  EXPECT_NEAR(force_n(networks, state_of({0.0, 0.0, 7.0}), {}), 1e-3 * 8.5, 1e-15);
}

test::RigParameters with_downwash(double strength) {
  auto p = test::FlightRig::small_camera();
  p.start_spacing_m = {};
  p.downwash_strength = strength;
  return p;
}

TEST(NeuralDownwash, PushesADroneAlongTheVerticalOfTheWorld) {
  const auto fall = [](double strength, double yaw_rad) {
    auto parameters = with_downwash(strength);
    parameters.start_yaw_offset_rad = yaw_rad;
    test::Fleet fleet(test::shipped_scene("empty"), parameters, {{0.0, 0.0, 5.0}, {0.5, 0.0, 6.0}}, small_networks());
    fleet.step(1'000'000);
    return fleet.drones;
  };
  const auto without = fall(0.0, 0.0);
  const auto with = fall(2.0, 0.0);
  // Relative to the first drone, the second drone is at (0.5, 0, 1) m, so phi is 3.5. The first drone is 5.0145 m high,
  // so its force is max(3.5 - 5.0145, 0) - 0 = 0.
  EXPECT_EQ(with[0].outputs.drone_velocity_m_per_s, without[0].outputs.drone_velocity_m_per_s);
  auto networks = small_networks();
  networks.phi_ground.clear();
  test::Fleet fleet(test::shipped_scene("empty"), with_downwash(2.0), {{0.0, 0.0, 5.0}, {0.5, 0.0, 6.0}}, networks);
  fleet.step(1'000'000);
  const double change_m_per_s =
      fleet.drones[0].outputs.drone_velocity_m_per_s[2] - without[0].outputs.drone_velocity_m_per_s[2];
  EXPECT_NEAR(change_m_per_s, 1e-3 * 2.0 * 3.5e-3 / without[0].outputs.drone_mass_kg, 1e-12);
  EXPECT_EQ(fleet.drones[0].outputs.drone_velocity_m_per_s[0], 0.0);
}

TEST(NeuralDownwash, NetworksWithStrengthZeroChangeNothingAndAreReported) {
  const std::vector<std::array<double, 3>> offsets{{0.0, 0.0, 5.0}, {0.5, 0.0, 6.0}};
  test::Fleet without(test::shipped_scene("empty"), with_downwash(0.0), offsets);
  test::Fleet with(test::shipped_scene("empty"), with_downwash(0.0), offsets, small_networks());
  EXPECT_THAT(with.events, testing::ElementsAre(HasSubstr("downwash.strength is 0")));
  for (int i = 0; i < 100; ++i) {
    with.step();
    without.step();
  }
  EXPECT_TRUE(mebots::test::same_state(with.world, without.world));
}

json layers_of(const scene::Network& network) {
  json layers = json::array();
  for (const auto& layer : network) {
    json rows = json::array();
    for (std::size_t i = 0; i < layer.outputs; ++i) {
      json row = json::array();
      for (std::size_t j = 0; j < layer.inputs; ++j) row.push_back(layer.weights[j * layer.outputs + i]);
      rows.push_back(row);
    }
    layers.push_back({{"weights", rows}, {"offsets", layer.offsets}});
  }
  return layers;
}

json content_of(const DownwashNetworks& networks) {
  const auto quantity = [](double value, const char* unit) {
    return json{{"value", value}, {"unit", unit}, {"source", "this test"}};
  };
  return {{"name", "small"},
          {"source", "this test"},
          {"force_per_output", quantity(networks.force_per_output_n, "N")},
          {"limits", {{"z", quantity(1.5, "m")}, {"velocity_x", quantity(2.5, "m/s")}, {"height", quantity(3.5, "m")}}},
          {"phi", layers_of(networks.phi)},
          {"phi_ground", layers_of(networks.phi_ground)},
          {"rho", layers_of(networks.rho)}};
}

DownwashNetworks read(const json& content) {
  const std::string test = testing::UnitTest::GetInstance()->current_test_info()->name();
  const auto file = std::filesystem::path(testing::TempDir()) / ("downwash_" + test + ".json");
  std::ofstream(file) << content.dump(1);
  return scene::load_downwash_networks(file);
}

std::string error_of(const json& content) {
  try {
    static_cast<void>(read(content));
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(NeuralDownwash, ReadsTheFileThatItWasWrittenTo) {
  const auto written = small_networks();
  const auto networks = read(content_of(written));
  EXPECT_EQ(networks.name, "small");
  EXPECT_EQ(networks.force_per_output_n, 1e-3);
  EXPECT_FALSE(networks.include_alone);
  constexpr double kNo = DownwashNetworks::kNoLimit;
  EXPECT_THAT(networks.neighbour_limits, testing::ElementsAre(kNo, kNo, 1.5, 2.5, kNo, kNo));
  EXPECT_EQ(networks.height_limit_m, 3.5);
  EXPECT_EQ(layers_of(networks.phi), layers_of(written.phi));
  EXPECT_EQ(layers_of(networks.phi_ground), layers_of(written.phi_ground));
  EXPECT_EQ(layers_of(networks.rho), layers_of(written.rho));
}

TEST(NeuralDownwash, ErrorsNamePlaceAndNumbersThatDoNotMatch) {
  const auto good = content_of(small_networks());
  const auto changed = [&](const char* pointer, const json& value) {
    auto content = good;
    content[json::json_pointer(pointer)] = value;
    return error_of(content);
  };
  EXPECT_THAT(changed("/phi/0/weights/1", {1.0, 2.0}),
              AllOf(HasSubstr("downwash_ErrorsName"), HasSubstr("/phi/0/weights/1"), HasSubstr("2 numbers"),
                    HasSubstr("first row has 6")));
  EXPECT_THAT(changed("/phi/0/offsets", {1.0}), AllOf(HasSubstr("/phi/0/offsets"), HasSubstr("2 rows")));
  EXPECT_THAT(changed("/rho/1/weights", {{1.0, 2.0}}), AllOf(HasSubstr("/rho/1/weights"), HasSubstr("2 inputs")));
  EXPECT_THAT(changed("/rho/1", {{"weights", {{1.0}, {2.0}}}, {"offsets", {0.0, 0.0}}}),
              AllOf(HasSubstr("/rho"), HasSubstr("2 outputs, but needs 1")));
  EXPECT_THAT(changed("/phi_ground", good["phi"]), AllOf(HasSubstr("/phi_ground"), HasSubstr("6 inputs, but needs 4")));
  EXPECT_THAT(changed("/phi/0", {{"weights", {{1, 1, 1, 1, 1, 1}}}, {"offsets", {0}}}),
              AllOf(HasSubstr("/phi"), HasSubstr("1 outputs, but the first layer of rho has 2")));
  EXPECT_THAT(changed("/phi", json::array()), HasSubstr("1 to 16 layers"));
  EXPECT_THAT(changed("/phi/0/weights/0/0", 1e7), HasSubstr("/phi/0/weights/0/0"));
  EXPECT_THAT(changed("/force_per_output/unit", "g"), HasSubstr("/force_per_output/unit"));
  EXPECT_THAT(changed("/limits/zz", 1), HasSubstr("zz"));
}

}  // namespace
}  // namespace mebots::world
