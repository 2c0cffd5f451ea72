// SPDX-License-Identifier: Apache-2.0
// mebots-dataset: pictures as the drone's network gets them, with the command that the expert gives to each.
//
// Every picture is taken by the camera of fmu_world, disturbed, and made small by the firmware's own code. Writes
// two files: <out>.pictures, 168 x 168 bytes each (signed, grey level less 128), and <out>.labels.csv.

#include "camera/renderer.hpp"
#include "expert.hpp"
#include "mebots/error.hpp"
#include "nn/shrink.h"
#include "room.hpp"
#include "scene/load.hpp"

#include <fmt/format.h>
#include <fmt/os.h>
#include <CLI/CLI.hpp>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;
using mebots::training::Advice;
using mebots::training::Random;
using mebots::training::Visibility;

struct Options {
  std::string out;
  std::string scene;
  std::uint64_t seed = 1;
  int scenes = 100;
  int pictures = 16;
  double field_of_view_rad = 0.0;  ///< 0 = another one in each room
};

/// How a picture is spoilt on its way from the renderer to the network.
struct Disturbance {
  int blur_px = 1;  // width of a level box blur, as a turning drone's exposure makes it
  double gain = 1.0;
  double offset = 0.0;
};

Disturbance random_disturbance(Random& random) {
  Disturbance d;
  if (random.chance(0.35)) d.blur_px = 2 + random.below(4);
  if (random.chance(0.7)) {
    d.gain = random.between(0.6, 1.3);
    d.offset = random.between(-25.0, 25.0);
  }
  return d;
}

void disturb(const Disturbance& d, int width, std::vector<std::uint8_t>& pixels) {
  if (d.blur_px == 1 && d.gain == 1.0 && d.offset == 0.0) return;
  std::vector<double> sums(static_cast<std::size_t>(width) + 1);
  for (std::size_t row = 0; row < pixels.size(); row += static_cast<std::size_t>(width)) {
    for (int x = 0; x < width; ++x) sums[x + 1] = sums[x] + pixels[row + x];
    for (int x = 0; x < width; ++x) {
      const int begin = std::max(0, x - d.blur_px / 2);
      const int end = std::min(width, begin + d.blur_px);
      const double mean = (sums[end] - sums[begin]) / (end - begin);
      pixels[row + x] = static_cast<std::uint8_t>(std::clamp(std::lround(d.gain * mean + d.offset), 0L, 255L));
    }
  }
}

/// A place and attitude of the drone, most often with the gate ahead.
struct BodyPose {
  Vector3d p_WB_m;
  Eigen::Matrix3d R_WB;
};

BodyPose random_pose(Random& random, const mebots::world::scene::Scene& scene, double half_view_rad) {
  double yaw = random.between(-M_PI, M_PI);
  Vector3d p{random.between(-1.5, 4.0), random.between(-2.0, 2.0), 1.0 + random.normal(0.06)};
  if (!scene.gates.empty() && random.chance(0.9)) {
    const auto& gate = scene.gates[0];
    // Far places more often than a uniform logarithm has them: there the picture says least.
    const double distance = random.chance(0.6) ? random.between(0.8, 7.5) : random.log_between(0.15, 2.0);
    const double off_axis = random.chance(0.5) ? random.normal(0.25) : random.between(-1.05, 1.05);
    const double towards = gate.yaw_rad + off_axis;
    p.head<2>() = gate.p_W_m.head<2>() - distance * Vector3d(std::cos(towards), std::sin(towards), 0.0).head<2>();
    p.z() = gate.p_W_m.z() - 0.03 + random.normal(0.06);
    const double bearing = random.chance(0.4) ? random.normal(0.12) : random.between(-1.1, 1.1) * half_view_rad;
    yaw = towards - bearing;
  }
  const Eigen::Matrix3d R = (AngleAxisd(yaw, Vector3d::UnitZ()) * AngleAxisd(random.normal(0.035), Vector3d::UnitY()) *
                             AngleAxisd(random.normal(0.035), Vector3d::UnitX()))
                                .toRotationMatrix();
  return {p, R};
}

bool inside(const mebots::world::scene::Box& box, const Vector3d& p_W, double margin_m) {
  const Vector3d p = AngleAxisd(-box.yaw_rad, Vector3d::UnitZ()) * (p_W - box.p_W_m);
  return (p.cwiseAbs() - 0.5 * box.size_m).maxCoeff() < margin_m;
}

/// Whether the drone can be at `p` and nothing stands between it and the gate.
bool free_view(const mebots::world::scene::Scene& scene, const Vector3d& p_W) {
  for (const auto& box : scene.boxes) {
    if (inside(box, p_W, 0.1)) return false;
    if (scene.gates.empty()) continue;
    const auto& gate = scene.gates[0];
    const Vector3d left = AngleAxisd(gate.yaw_rad, Vector3d::UnitZ()) * Vector3d::UnitY();
    constexpr int kSteps = 60;
    for (const double side : {-0.5, 0.0, 0.5}) {
      const Vector3d goal = gate.p_W_m + side * gate.outer_m * left;
      for (int i = 0; i < kSteps; ++i) {
        if (inside(box, p_W + (i + 0.5) / kSteps * (goal - p_W), 0.3 * i / kSteps)) return false;
      }
    }
  }
  return true;
}

/// The outermost walls bound the room: the first four boxes of every scene.
bool in_room(const mebots::world::scene::Scene& scene, const Vector3d& p_W) {
  Vector3d low = Vector3d::Constant(1e9);
  Vector3d high = -low;
  for (const auto& box : scene.boxes) {
    low = low.cwiseMin(box.p_W_m);
    high = high.cwiseMax(box.p_W_m);
  }
  return (p_W - low).head<2>().minCoeff() > 0.3 && (high - p_W).head<2>().minCoeff() > 0.3;
}

class Writer {
 public:
  explicit Writer(const std::string& out)
      : pictures_(out + ".pictures", std::ios::binary), labels_(out + ".labels.csv"), path_(out) {
    labels_ << "yaw,visible,strength,distance_m,offset,field_of_view_rad,scene\n";
  }
  void add(const std::vector<std::int8_t>& picture, const Advice& advice, double field_of_view_rad, int scene) {
    pictures_.write(reinterpret_cast<const char*>(picture.data()), static_cast<std::streamsize>(picture.size()));
    labels_ << fmt::format("{:.6f},{:d},{:.3f},{:.4f},{:.5f},{:.5f},{}\n", advice.yaw,
                           advice.visibility == Visibility::enough, advice.strength, advice.distance_m, advice.offset,
                           field_of_view_rad, scene);
  }
  void finish() {
    if (!pictures_.flush() || !labels_.flush()) {
      throw mebots::Error(fmt::format("{}: cannot write; does its folder exist, is the disk full?", path_));
    }
  }

 private:
  std::ofstream pictures_;
  std::ofstream labels_;
  std::string path_;
};

/// Lenses between that of Webots' Crazyflie and that of Stargate's recordings.
constexpr double kNarrowest_rad = 0.87;
constexpr double kWidest_rad = 1.51844;

void take_pictures(const mebots::world::scene::Scene& scene, int scene_number, const Options& options, Random& random,
                   Writer& writer) {
  mebots::world::camera::Intrinsics intrinsics;
  intrinsics.horizontal_field_of_view_rad =
      options.field_of_view_rad > 0.0 ? options.field_of_view_rad : random.between(kNarrowest_rad, kWidest_rad);
  const int count = options.pictures;
  mebots::world::camera::Renderer renderer(scene, intrinsics, random.between(0.0, 5.0));
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(intrinsics.width) * intrinsics.height);
  std::vector<std::int8_t> small(static_cast<std::size_t>(SHRUNK_EDGE) * SHRUNK_EDGE);
  std::array<std::uint16_t, SHRUNK_EDGE> columns{};
  shrink_columns(intrinsics.width, columns.data());
  for (int taken = 0, tries = 0; taken < count && tries < 100 * count; ++tries) {
    const BodyPose pose = random_pose(random, scene, 0.5 * intrinsics.horizontal_field_of_view_rad);
    if (!in_room(scene, pose.p_WB_m) || !free_view(scene, pose.p_WB_m)) continue;
    const auto camera = mebots::world::camera::camera_pose({}, pose.p_WB_m, pose.R_WB);
    const Advice advice = mebots::training::expert(scene, intrinsics, camera);
    if (advice.visibility == Visibility::sliver) continue;
    renderer.render(camera, random.word(), static_cast<std::uint64_t>(taken), pixels);
    disturb(random_disturbance(random), intrinsics.width, pixels);
    for (int y = 0; y < SHRUNK_EDGE; ++y) {
      shrink_row(&pixels[static_cast<std::size_t>(shrink_place(y, intrinsics.height)) * intrinsics.width],
                 intrinsics.width, columns.data(), &small[static_cast<std::size_t>(y) * SHRUNK_EDGE]);
    }
    writer.add(small, advice, intrinsics.horizontal_field_of_view_rad, scene_number);
    ++taken;
  }
}

Options read_options(int argc, char** argv) {
  Options options;
  CLI::App app("Pictures of random rooms as the drone's network gets them, with the expert's yaw commands");
  app.add_option("--out", options.out, "Path of the files to write, without their endings")->required();
  app.add_option("--seed", options.seed, "Other seeds, other rooms")->capture_default_str();
  app.add_option("--scenes", options.scenes, "Number of rooms")->check(CLI::Range(1, 1000000))->capture_default_str();
  app.add_option("--pictures", options.pictures, "Pictures of each room")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  app.add_option("--field-of-view", options.field_of_view_rad, "Of the lens [rad]; default: another one in each room")
      ->check(CLI::Range(0.1, 3.0));
  app.add_option("--scene", options.scene, "A scene file instead of random rooms")->check(CLI::ExistingFile);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::exit(app.exit(error));
  }
  return options;
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = read_options(argc, argv);
  try {
    Writer writer(options.out);
    for (int i = 0; i < options.scenes; ++i) {
      // Each room has its own numbers, so that a room does not depend on those before it.
      Random random(options.seed * 1000003U + static_cast<std::uint64_t>(i));
      const auto scene = options.scene.empty() ? mebots::training::random_room(random)
                                               : mebots::world::scene::load_scene(options.scene);
      take_pictures(scene, i, options, random, writer);
    }
    writer.finish();
  } catch (const mebots::Error& error) {
    fmt::print(stderr, "mebots-dataset: {}\n", error.what());
    return 1;
  }
  return 0;
}
