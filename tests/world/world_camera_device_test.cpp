// SPDX-License-Identifier: Apache-2.0
#include "support/flight_rig.hpp"

#include <gtest/gtest.h>
#include <algorithm>

namespace mebots::world {
namespace {

using test::FlightRig;
using test::shipped_scene;

std::vector<std::uint8_t> copy(const fmu::BinaryRef& frame) {
  const auto bytes = frame.bytes();
  return {bytes.begin(), bytes.end()};
}

test::RigParameters parameters() {
  test::RigParameters p = FlightRig::small_camera();
  p.camera_width = 64;
  p.camera_height = 48;
  p.camera_noise = 0.0;
  return p;
}

TEST(CameraDevice, HasNoPictureBeforeTheFirstRequest) {
  FlightRig rig(shipped_scene("gate_easy"), parameters());
  rig.run(0.1);
  EXPECT_EQ(rig.outputs.camera_frame_id, 0);
  EXPECT_TRUE(rig.outputs.camera_frame.bytes().empty());
}

TEST(CameraDevice, AnswersARequestAtTheEndOfTheStepThatSeesIt) {
  FlightRig rig(shipped_scene("gate_easy"), parameters());
  rig.inputs.camera_trigger = 3;
  rig.step();
  EXPECT_EQ(rig.outputs.camera_frame_id, 3);
  EXPECT_EQ(rig.outputs.camera_frame.bytes().size(), 64U * 48U);
}

TEST(CameraDevice, ReportsTheSettingsOfThePicture) {
  FlightRig instant(shipped_scene("gate_easy"), parameters());
  EXPECT_EQ(instant.outputs.camera_frame_gain, 0.0);
  instant.inputs.camera_trigger = 1;
  instant.step();
  EXPECT_EQ(instant.outputs.camera_frame_exposure_s, 0.0);
  EXPECT_EQ(instant.outputs.camera_frame_gain, 1.0);

  test::RigParameters automatic = parameters();
  automatic.camera_exposure_s = 0.001;
  automatic.camera_auto_exposure = true;
  automatic.camera_auto_exposure_target = 200.0;
  FlightRig rig(shipped_scene("gate_easy"), automatic);
  rig.inputs.camera_trigger = 1;
  rig.step();
  EXPECT_DOUBLE_EQ(rig.outputs.camera_frame_exposure_s, 0.001);
  rig.inputs.camera_trigger = 2;
  rig.step();
  EXPECT_GT(rig.outputs.camera_frame_exposure_s, 0.001) << "the first one was too dark";
}

TEST(CameraDevice, ShowsTheViewAtTheBeginningOfTheStep) {
  // A fall from 1.3 m for half a second would change the picture considerably, but the picture must show the start of
  // the step.
  const auto picture_of_start = [] {
    test::RigParameters p = parameters();
    p.start_offset_m = {2.0, 0.0, 1.3};
    FlightRig rig(shipped_scene("gate_easy"), p);
    rig.inputs.camera_trigger = 1;
    rig.step(1'000'000);
    return copy(rig.outputs.camera_frame);
  };
  test::RigParameters p = parameters();
  p.start_offset_m = {2.0, 0.0, 1.3};
  FlightRig rig(shipped_scene("gate_easy"), p);
  rig.inputs.camera_trigger = 1;
  rig.step(100'000'000);
  EXPECT_EQ(copy(rig.outputs.camera_frame), picture_of_start());
  rig.inputs.camera_trigger = 2;
  rig.step();
  EXPECT_NE(copy(rig.outputs.camera_frame), picture_of_start());
}

TEST(CameraDevice, TakesNoPictureWhileTheCountStays) {
  FlightRig rig(shipped_scene("gate_easy"), parameters());
  rig.inputs.camera_trigger = 1;
  rig.step();
  const auto* data = rig.outputs.camera_frame.bytes().data();
  rig.run(0.1);
  EXPECT_EQ(rig.outputs.camera_frame_id, 1);
  EXPECT_EQ(rig.outputs.camera_frame.bytes().data(), data);
}

TEST(CameraDevice, APictureStaysReadableUntilTheNextStepEnds) {
  test::RigParameters p = parameters();
  p.camera_noise = 5.0;  // makes every picture different
  FlightRig rig(shipped_scene("gate_easy"), p);
  rig.inputs.camera_trigger = 1;
  rig.step();
  const fmu::BinaryRef held = rig.outputs.camera_frame;
  const auto before = copy(held);
  rig.inputs.camera_trigger = 2;
  rig.step();
  EXPECT_EQ(copy(held), before);
  EXPECT_NE(copy(rig.outputs.camera_frame), before);
}

TEST(CameraDevice, NoiseOfAPictureDependsOnItsNumberAlone) {
  test::RigParameters p = parameters();
  p.camera_noise = 5.0;
  FlightRig one(shipped_scene("gate_easy"), p);
  one.inputs.camera_trigger = 7;
  one.step();
  FlightRig many(shipped_scene("gate_easy"), p);
  for (int i = 5; i <= 7; ++i) {
    many.inputs.camera_trigger = i;
    many.step();
  }
  // The drone is at rest on the ground, so its camera hardly moves. Without noise, the pictures would differ by much
  // less than a grey level.
  const auto a = copy(one.outputs.camera_frame);
  const auto b = copy(many.outputs.camera_frame);
  int largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(int{a[i]} - int{b[i]}));
  EXPECT_LE(largest, 1);
}

TEST(CameraDevice, SeesTheGateInTheEasySceneAheadAtFlightAltitude) {
  test::RigParameters p = parameters();
  p.start_offset_m = {0.0, 0.0, 1.0};
  FlightRig rig(shipped_scene("gate_easy"), p);
  rig.inputs.camera_trigger = 1;
  rig.step();
  const auto frame = copy(rig.outputs.camera_frame);
  // The bright frame, 0.6 m wide at 5 m, is near the centre of the picture. Nothing else is as bright.
  const auto brightest = std::max_element(frame.begin(), frame.end());
  const auto index = static_cast<int>(brightest - frame.begin());
  EXPECT_NEAR(index % 64, 32, 6);
  EXPECT_NEAR(index / 64, 24, 6);
}

}  // namespace
}  // namespace mebots::world
