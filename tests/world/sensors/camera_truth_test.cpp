// SPDX-License-Identifier: Apache-2.0
// Tests the boxes of objects and the depth pictures of a drone's camera.
#include "support/fleet.hpp"
#include "support/flight_rig.hpp"
#include "support/same_state.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace mebots::world {
namespace {

using nlohmann::json;
using test::FlightRig;

test::RigParameters with_truth() {
  test::RigParameters parameters = FlightRig::small_camera();
  parameters.camera_width = 64;
  parameters.camera_height = 48;
  parameters.camera_labels = true;
  parameters.camera_depth_enabled = true;
  parameters.start_offset_m = {3.0, 0.0, 1.0};
  return parameters;
}

std::vector<std::uint8_t> copy(const fmu::BinaryRef& ref) {
  const auto bytes = ref.bytes();
  return {bytes.begin(), bytes.end()};
}

TEST(CameraTruth, IsOffByDefault) {
  FlightRig rig(test::shipped_scene("gate_easy"));
  rig.inputs.camera_trigger = 1;
  rig.step();
  EXPECT_EQ(rig.world.camera()->objects_text(), "");
  EXPECT_TRUE(rig.outputs.camera_depth.bytes().empty());
}

TEST(CameraTruth, DescribesTheLastPicture) {
  const auto scene = test::shipped_scene("gate_easy");
  FlightRig rig(scene, with_truth());
  EXPECT_EQ(json::parse(rig.world.camera()->objects_text()), json::parse(R"({"frame_id": 0, "objects": []})"));
  const Eigen::Vector3d body_W_m(rig.outputs.drone_position_m.data());
  rig.inputs.camera_trigger = 5;
  rig.step();
  const json text = json::parse(rig.world.camera()->objects_text());
  EXPECT_EQ(text["frame_id"], 5);
  ASSERT_EQ(text["objects"].size(), 1U);
  const json& gate = text["objects"][0];
  EXPECT_EQ(gate["class"], "gate");
  EXPECT_EQ(gate["name"], "gate 1");
  EXPECT_EQ(gate["visible"], 1.0);
  const Eigen::Vector3d camera_W_m = body_W_m + Eigen::Vector3d(0.027, 0.0, 0.012);
  EXPECT_NEAR(gate["distance"].get<double>(), (scene.gates[0].p_W_m - camera_W_m).norm(), 1e-12);

  const auto depth = copy(rig.outputs.camera_depth);
  ASSERT_EQ(depth.size(), 2U * 64U * 48U);
  // The frame's left side is between the columns `left` and `right`. Its front is 15 mm in front of the gate's middle.
  const int row = (gate["box"][1].get<int>() + gate["box"][3].get<int>()) / 2;
  const std::size_t pixel = static_cast<std::size_t>(row) * 64 + gate["box"][0].get<std::size_t>();
  const double depth_m = 0.001 * (depth[2 * pixel] + 256 * depth[2 * pixel + 1]);
  EXPECT_NEAR(depth_m, scene.gates[0].p_W_m.x() - 0.015 - camera_W_m.x(), 0.0005 + 1e-4);
}

TEST(CameraTruth, ARestoredWorldHasTheSameTruth) {
  auto parameters = with_truth();
  parameters.camera_depth_noise_per_m = 0.002;
  parameters.camera_exposure_s = 0.01;
  parameters.camera_line_time_s = 1e-4;
  FlightRig straight(test::shipped_scene("gate_easy"), parameters);
  straight.inputs.camera_trigger = 1;
  straight.run(0.1);  // falls
  FlightRig other(test::shipped_scene("gate_easy"), parameters);
  other.continue_from(straight);
  EXPECT_EQ(other.world.camera()->objects_text(), straight.world.camera()->objects_text());
  EXPECT_EQ(copy(other.outputs.camera_depth), copy(straight.outputs.camera_depth));
  for (auto* rig : {&straight, &other}) {
    rig->inputs.camera_trigger = 2;
    rig->step();
  }
  EXPECT_TRUE(mebots::test::same_state(straight.world, other.world));
  EXPECT_EQ(copy(other.outputs.camera_depth), copy(straight.outputs.camera_depth));
  EXPECT_EQ(other.world.camera()->objects_text(), straight.world.camera()->objects_text());
}

TEST(CameraTruth, ChangesNoPicture) {
  FlightRig with(test::shipped_scene("gate_easy"), with_truth());
  auto parameters = with_truth();
  parameters.camera_labels = false;
  parameters.camera_depth_enabled = false;
  FlightRig without(test::shipped_scene("gate_easy"), parameters);
  for (auto* rig : {&with, &without}) {
    rig->inputs.camera_trigger = 1;
    rig->step();
  }
  EXPECT_EQ(copy(with.outputs.camera_frame), copy(without.outputs.camera_frame));
}

TEST(CameraTruth, ADroneSeesAnother) {
  test::RigParameters parameters = with_truth();
  parameters.start_spacing_m = {};
  test::Fleet fleet(test::shipped_scene("empty"), parameters, {{0.0, 0.0, 1.0}, {1.0, 0.1, 1.0}});
  for (auto& drone : fleet.drones) drone.inputs.camera_trigger = 1;
  fleet.step();
  const json first = json::parse(fleet.world.camera(0)->objects_text());
  ASSERT_EQ(first["objects"].size(), 1U);
  EXPECT_EQ(first["objects"][0]["class"], "drone");
  EXPECT_EQ(first["objects"][0]["name"], "drone[2]");
  EXPECT_NEAR(first["objects"][0]["distance"].get<double>(), Eigen::Vector3d(0.973, 0.1, -0.012).norm(), 1e-9);
  EXPECT_TRUE(json::parse(fleet.world.camera(1)->objects_text())["objects"].empty()) << "it looks the other way";
  EXPECT_EQ(fleet.world.camera(2), nullptr);
}

}  // namespace
}  // namespace mebots::world
