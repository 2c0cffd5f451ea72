// SPDX-License-Identifier: Apache-2.0
// Tests lens and sensor. Compares each effect alone with its formula.
#include "camera/sensor.hpp"
#include "camera_scenes.hpp"
#include "mebots/error.hpp"
#include "support/allocations.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cmath>
#include <numeric>

namespace mebots::world::camera {
namespace {

using Eigen::Vector3d;
using testing::Picture;
using testing::pose;

const Vector3d kEye{0.0, 0.0, 1.0};

Picture taken(Sensor& sensor, const PoseAt& pose_at, const Intrinsics& size = {}, std::uint64_t frame = 0) {
  Picture picture{size.width, std::vector<std::uint8_t>(static_cast<std::size_t>(size.width) * size.height)};
  sensor.take(pose_at, 1, frame, picture.pixels);
  return picture;
}

PoseAt still(const Pose& from) {
  return [from](double after_s) {
    Pose then = from;
    then.time_ns += std::llround(after_s * 1e9);
    return then;
  };
}

PoseAt turning(double rate_rad_per_s) {
  return [=](double after_s) { return pose(kEye, rate_rad_per_s * after_s); };
}

double mean_of(const Picture& picture) {
  return static_cast<double>(std::accumulate(picture.pixels.begin(), picture.pixels.end(), 0LL)) /
         static_cast<double>(picture.pixels.size());
}

/// Returns a wall of one grey level. The wall fills the view.
scene::Scene grey_wall(double grey) {
  scene::Scene scene = testing::dark_scene();
  scene.boxes = {{"wall", {3.0, 0.0, 1.0}, {0.1, 40.0, 40.0}, 0.0, testing::uniform(grey)}};
  scene.ground.half_size_m = 1e-3;
  return scene;
}

/// Returns a white vertical strip on black, straight ahead.
scene::Scene strip(double left_m = 0.0) {
  scene::Scene scene = grey_wall(0.0);
  scene.boxes.push_back({"strip", {2.8755, left_m, 1.0}, {0.001, 0.1, 6.0}, 0.0, testing::uniform(200.0)});
  return scene;
}

double centre_of(const Picture& picture, int row) {
  double sum = 0.0;
  double weight = 0.0;
  for (int column = 0; column < picture.width; ++column) {
    sum += picture.at(column, row) * (column + 0.5);
    weight += picture.at(column, row);
  }
  return sum / weight;
}

TEST(CameraSensor, EqualsTheRendererWithoutEffects) {
  const scene::Scene scene = testing::patterned_room();
  Renderer renderer(scene, {}, 0.0);
  Sensor sensor(scene, {}, {}, {});
  for (const Pose& from : testing::awkward_poses()) {
    EXPECT_EQ(testing::picture(renderer, from), taken(sensor, still(from)));
  }
}

TEST(CameraSensor, AnExposureOfAStillSceneChangesNothing) {
  const scene::Scene scene = testing::patterned_room();
  SensorSettings settings;
  settings.exposure_s = 0.02;
  settings.line_time_s = 6e-5;
  Sensor exposed(scene, {}, {}, settings);
  Renderer renderer(scene, {}, 0.0);
  const Pose from = pose(kEye);
  const Picture a = taken(exposed, still(from));
  const Picture b = testing::picture(renderer, from);
  for (std::size_t i = 0; i < a.pixels.size(); ++i)
    ASSERT_NEAR(a.pixels[i], b.pixels[i], 1);  // rounding of a mean of 8
}

TEST(CameraLens, BendsRaysAsBrownsFormulaSays) {
  for (const auto& [k1, k2] : {std::pair{-0.12, 0.01}, std::pair{0.08, 0.0}, std::pair{-0.05, 0.0}}) {
    for (const double left_m : {-2.0, -1.0, 0.4, 1.7}) {
      Sensor sensor(strip(left_m), {}, {k1, k2, 0.0}, {});
      const Picture seen = taken(sensor, still(pose(kEye)));
      const double f = Intrinsics{}.focal_length_px();
      // The strip's front is 2.875 m in front of the camera. r is the tangent of the angle between the optical axis and
      // the strip.
      const double r = left_m / 2.875;
      const double bent = r * (1.0 + k1 * r * r + k2 * r * r * r * r);
      EXPECT_NEAR(centre_of(seen, 160), 160.0 - f * bent, 0.6) << k1 << " " << left_m;
    }
  }
}

TEST(CameraLens, RefusesADistortionThatFoldsThePicture) {
  EXPECT_THROW(Sensor(strip(), {}, {-0.9, 0.0, 0.0}, {}), Error);
  EXPECT_THROW(Sensor(strip(), {}, {NAN, 0.0, 0.0}, {}), Error);
}

TEST(CameraLens, DarkensCornersByCosToTheFourth) {
  Sensor sensor(grey_wall(200.0), {}, {0.0, 0.0, 1.0}, {});
  const Picture seen = taken(sensor, still(pose(kEye)));
  const double f = Intrinsics{}.focal_length_px();
  for (const auto& [column, row] : {std::pair{160, 160}, std::pair{0, 160}, std::pair{0, 0}, std::pair{300, 40}}) {
    const double x = (column + 0.5 - 160.0) / f;
    const double y = (row + 0.5 - 160.0) / f;
    const double cosine = 1.0 / std::sqrt(1.0 + x * x + y * y);
    EXPECT_NEAR(seen.at(column, row), 200.0 * std::pow(cosine, 4), 0.51);
  }
}

TEST(CameraSensor, LightIsProportionalToExposureAndGain) {
  SensorSettings settings;
  settings.exposure_s = 0.008;
  settings.reference_exposure_s = 0.016;
  settings.gain = 3.0;
  Sensor sensor(grey_wall(100.0), {}, {}, settings);
  EXPECT_EQ(taken(sensor, still(pose(kEye))).at(160, 160), 150);
}

TEST(CameraSensor, MotionBlurIsAsWideAsTheTurnWhileItIsExposed) {
  SensorSettings settings;
  settings.exposure_s = 0.02;
  settings.blur_samples = 64;
  const double rate = 2.0;
  Sensor sensor(strip(), {}, {}, settings);
  const Picture seen = taken(sensor, turning(rate));
  SensorSettings sharp_settings = settings;
  sharp_settings.blur_samples = 1;
  Sensor sharp(strip(), {}, {}, sharp_settings);
  const Picture instant = taken(sharp, turning(rate));
  const auto white = [](const Picture& picture) {
    int count = 0;
    double light = 0.0;
    for (int column = 0; column < 320; ++column) {
      count += picture.at(column, 160) > 0 ? 1 : 0;
      light += picture.at(column, 160);
    }
    return std::pair(count, light);
  };
  const auto [wide, light] = white(seen);
  const auto [narrow, same_light] = white(instant);
  const double way_px = Intrinsics{}.focal_length_px() * std::tan(rate * settings.exposure_s);
  EXPECT_NEAR(wide - narrow, way_px, 1.5);
  EXPECT_NEAR(light, same_light, 200.0);  // a pixel at a sharp edge is inside or outside
  // If blur_samples is 1, the only rendering is at the middle of the exposure.
  EXPECT_NEAR(centre_of(seen, 160), centre_of(instant, 160), 0.5);
}

TEST(CameraSensor, ARollingShutterLeansWhatIsUprightByTheTimeOfItsRows) {
  SensorSettings settings;
  settings.line_time_s = 62.7e-6;
  const double rate = 1.0;
  Sensor sensor(strip(), {}, {}, settings);
  const Picture seen = taken(sensor, turning(rate));
  const double f = Intrinsics{}.focal_length_px();
  // A rotation to the left moves the strip to the right.
  for (const int row : {20, 100, 160, 300}) {
    const double band_middle = (row / 8) * 8 + 3.5;
    EXPECT_NEAR(centre_of(seen, row), 160.0 + f * std::tan(rate * settings.line_time_s * band_middle), 0.6) << row;
  }
}

TEST(CameraSensor, AMoverMovesWhileThePictureIsTaken) {
  scene::Scene scene = strip();
  scene.boxes.back().path.points = {{0, Vector3d::Zero(), 0.0}, {1'000'000'000, {0.0, -4.0, 0.0}, 0.0}};
  SensorSettings settings;
  settings.line_time_s = 62.7e-6;
  Sensor sensor(scene, {}, {}, settings);
  const Picture seen = taken(sensor, still(pose(kEye)));
  const double per_row_px = Intrinsics{}.focal_length_px() * 4.0 * settings.line_time_s / 2.875;
  EXPECT_NEAR(centre_of(seen, 300) - centre_of(seen, 20), 280 * per_row_px, 1.0);
}

TEST(CameraSensor, ShotNoiseHasTheVarianceOfCountedElectrons) {
  for (const double grey : {40.0, 160.0}) {
    for (const double gain : {1.0, 4.0}) {
      SensorSettings settings;
      settings.full_well = 7400.0;
      settings.noise_std = 1.5;
      settings.gain = gain;
      Sensor sensor(grey_wall(grey / gain), {}, {}, settings);
      const Picture seen = taken(sensor, still(pose(kEye)));
      double square = 0.0;
      for (const std::uint8_t pixel : seen.pixels) square += (pixel - grey) * (pixel - grey);
      const double variance = square / static_cast<double>(seen.pixels.size());
      // A pixel has n = (grey / gain) (well / 255) electrons. Each electron adds 255 gain / well grey levels, so the
      // variance is n (255 gain / well)^2 = grey gain 255 / well. The read noise adds 1.5^2, and rounding adds 1/12.
      // The variance of 102,400 pixels is accurate to 0.5 % (one standard deviation).
      const double expected = 1.5 * 1.5 + grey * gain * 255.0 / 7400.0 + 1.0 / 12.0;
      EXPECT_NEAR(variance, expected, 0.02 * expected) << grey << " " << gain;
    }
  }
}

TEST(CameraSensor, AutomaticExposureBringsThePicturesMeanToItsTarget) {
  for (const double grey : {8.0, 60.0, 250.0}) {
    SensorSettings settings;
    settings.exposure_s = 0.01;
    settings.automatic = true;
    settings.most_exposure_s = 0.0213;
    settings.blur_samples = 1;
    Sensor sensor(grey_wall(grey), {}, {}, settings);
    for (std::uint64_t i = 0; i < 8; ++i) taken(sensor, still(pose(kEye)), {}, i);
    EXPECT_NEAR(mean_of(taken(sensor, still(pose(kEye)))), settings.target, 5.5) << grey;
    EXPECT_LE(sensor.exposure_s(), settings.most_exposure_s);
    if (grey < 20.0) {
      EXPECT_GT(sensor.gain(), 1.0);
    } else if (grey > 100.0) {
      EXPECT_EQ(sensor.gain(), 1.0);
    }
  }
}

TEST(CameraSensor, AutomaticExposureEndsAtTheGreatestGain) {
  SensorSettings settings;
  settings.exposure_s = 0.01;
  settings.automatic = true;
  settings.most_exposure_s = 0.02;
  settings.most_gain = 4.0;
  Sensor sensor(grey_wall(2.0), {}, {}, settings);
  for (std::uint64_t i = 0; i < 8; ++i) taken(sensor, still(pose(kEye)), {}, i);
  EXPECT_EQ(sensor.gain(), 4.0);
  EXPECT_DOUBLE_EQ(sensor.exposure_s(), 0.02);
  EXPECT_NEAR(mean_of(taken(sensor, still(pose(kEye)))), 2.0 * 2.0 * 4.0, 0.51);
}

TEST(CameraSensor, TakesPicturesWithoutTheHeap) {
  SensorSettings settings;
  settings.exposure_s = 0.01;
  settings.automatic = true;
  settings.most_exposure_s = 0.02;
  settings.line_time_s = 6e-5;
  settings.full_well = 7400.0;
  Sensor sensor(testing::patterned_room(), {}, {-0.05, 0.0, 1.0}, settings);
  std::vector<std::uint8_t> pixels(320 * 320);
  const PoseAt from = still(pose(kEye));
  sensor.take(from, 1, 0, pixels);
  const auto before = mebots::test::allocations();
  sensor.take(from, 1, 1, pixels);
  EXPECT_EQ(mebots::test::allocations(), before);
}

TEST(CameraSensor, RefusesWhatMakesNoSensor) {
  const auto refuses = [](auto change) {
    SensorSettings settings;
    settings.exposure_s = 0.01;
    change(settings);
    EXPECT_THROW(Sensor(grey_wall(9.0), {}, {}, settings), Error);
  };
  refuses([](SensorSettings& s) { s.exposure_s = -0.1; });
  refuses([](SensorSettings& s) { s.gain = 0.0; });
  refuses([](SensorSettings& s) { s.line_time_s = NAN; });
  refuses([](SensorSettings& s) { s.blur_samples = 0; });
  refuses([](SensorSettings& s) { s.full_well = -1.0; });
  refuses([](SensorSettings& s) { s.noise_std = INFINITY; });
  refuses([](SensorSettings& s) { s.automatic = true; });  // the longest exposure is missing
}

}  // namespace
}  // namespace mebots::world::camera
