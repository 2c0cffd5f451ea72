// SPDX-License-Identifier: Apache-2.0
// mebots-camera: renders a picture of a scene from a given pose, to view scenes and to time the renderer.

#include "camera/renderer.hpp"
#include "mebots/error.hpp"
#include "scene/load.hpp"

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <Eigen/Geometry>

#include <algorithm>
#include <cstdint>
#include <ctime>
#include <fstream>
#include <string>
#include <vector>

namespace {

using mebots::world::camera::Intrinsics;
using mebots::world::camera::Mounting;
using mebots::world::camera::Renderer;

struct Options {
  std::string scene;
  std::string out = "picture.pgm";
  Eigen::Vector3d p_WB_m{0.0, 0.0, 1.0};
  double roll_rad = 0.0, pitch_rad = 0.0, yaw_rad = 0.0;
  Mounting mounting;
  Intrinsics intrinsics;
  double noise = 0.0;
  std::uint64_t seed = 1;
  std::uint64_t frame = 0;
  int repeat = 0;
};

void write_pgm(const std::string& path, const Intrinsics& size, const std::vector<std::uint8_t>& pixels) {
  std::ofstream file(path, std::ios::binary);
  file << fmt::format("P5\n{} {}\n255\n", size.width, size.height);
  file.write(reinterpret_cast<const char*>(pixels.data()), static_cast<std::streamsize>(pixels.size()));
  if (!file.flush()) throw mebots::Error(fmt::format("{}: cannot write the picture; does its folder exist?", path));
}

double processor_time_ms() {
  std::timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

void run(const Options& options) {
  Renderer renderer(mebots::world::scene::load_scene(options.scene), options.intrinsics, options.noise);
  const Eigen::Matrix3d R_WB = (Eigen::AngleAxisd(options.yaw_rad, Eigen::Vector3d::UnitZ()) *
                                Eigen::AngleAxisd(options.pitch_rad, Eigen::Vector3d::UnitY()) *
                                Eigen::AngleAxisd(options.roll_rad, Eigen::Vector3d::UnitX()))
                                   .toRotationMatrix();
  const auto pose = mebots::world::camera::camera_pose(options.mounting, options.p_WB_m, R_WB);
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(options.intrinsics.width) * options.intrinsics.height);
  renderer.render(pose, options.seed, options.frame, pixels);
  write_pgm(options.out, options.intrinsics, pixels);
  if (options.repeat > 0) {
    std::vector<double> spent_ms;
    for (int i = 0; i < options.repeat; ++i) {
      const double start_ms = processor_time_ms();
      renderer.render(pose, options.seed, static_cast<std::uint64_t>(i), pixels);
      spent_ms.push_back(processor_time_ms() - start_ms);
    }
    std::sort(spent_ms.begin(), spent_ms.end());
    fmt::print("{:.3f} ms of processor time per frame (median of {}; fastest {:.3f} ms)\n",
               spent_ms[spent_ms.size() / 2], spent_ms.size(), spent_ms.front());
  }
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Renders a scene as the drone's camera sees it, into a PGM file");
  app.add_option("scene", options.scene, "Scene file (JSON)")->required();
  app.add_option("--x", options.p_WB_m.x(), "Body position east [m]")->capture_default_str();
  app.add_option("--y", options.p_WB_m.y(), "Body position north [m]")->capture_default_str();
  app.add_option("--z", options.p_WB_m.z(), "Body position up [m]")->capture_default_str();
  app.add_option("--roll", options.roll_rad, "Roll [rad]")->capture_default_str();
  app.add_option("--pitch", options.pitch_rad, "Pitch [rad], positive = nose down")->capture_default_str();
  app.add_option("--yaw", options.yaw_rad, "Yaw [rad], positive = left")->capture_default_str();
  app.add_option("--camera-pitch", options.mounting.pitch_rad, "Camera pitch in the body [rad], positive looks down");
  app.add_option("--width", options.intrinsics.width, "Pixels")->capture_default_str();
  app.add_option("--height", options.intrinsics.height, "Pixels")->capture_default_str();
  app.add_option("--fov", options.intrinsics.horizontal_field_of_view_rad, "Horizontal field of view [rad]")
      ->capture_default_str();
  app.add_option("--noise", options.noise, "Standard deviation of pixel noise [grey levels]")->capture_default_str();
  app.add_option("--seed", options.seed, "Seed of the noise")->capture_default_str();
  app.add_option("--frame", options.frame, "Frame number, for the noise")->capture_default_str();
  app.add_option("--repeat", options.repeat, "Render this many more times and print the median processor time");
  app.add_option("--out", options.out, "PGM file to write")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    run(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "mebots-camera: {}\n", error.what());
    return 1;
  }
  return 0;
}
