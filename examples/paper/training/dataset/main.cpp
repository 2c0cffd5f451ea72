// SPDX-License-Identifier: Apache-2.0
// mebots-dataset: writes pictures in the format of the drone's network. Each picture has a label: the expert's command,
// or the position of the gate (--task sight).
//
// fmu_world's camera takes every picture. The picture is then disturbed, and reduced by the firmware's own code. Writes
// two files: <out>.pictures, 168 x 168 bytes each (signed, grey level minus 128), and <out>.labels.csv.

#include "camera/renderer.hpp"
#include "expert.hpp"
#include "frame.hpp"
#include "hall.hpp"
#include "mebots/error.hpp"
#include "nn/shrink.h"
#include "room.hpp"
#include "scene/load.hpp"
#include "sight.hpp"

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
#include <map>
#include <string>
#include <vector>

namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;
using mebots::training::Advice;
using mebots::training::Random;
using mebots::training::Sight;
using mebots::training::Visibility;

/// The output of the network: the expert's command, or the position of the gate.
enum class Task { command, sight };

struct Options {
  std::string out;
  Task task = Task::command;
  std::string scene;
  std::uint64_t seed = 1;
  int scenes = 100;
  int pictures = 16;
  double field_of_view_rad = 0.0;  ///< 0 means a different value in each room
  bool clutter = false;            ///< if true, takes pictures in random rooms with much clutter
};

/// The disturbances of a picture between the renderer and the network.
struct Disturbance {
  int blur_px = 1;    // width of a horizontal box blur, due to the exposure of a turning drone
  int blur_rows = 1;  // height of a vertical box blur, due to a climbing or pitching drone
  double gain = 1.0;
  double offset = 0.0;
  double vignetting = 0.0;  // relative loss of light in a corner
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

/// Returns a stronger disturbance for the sight network.
Disturbance strong_disturbance(Random& random) {
  Disturbance d;
  if (random.chance(0.4)) d.blur_px = 2 + random.below(6);
  if (random.chance(0.15)) d.blur_rows = 2 + random.below(4);
  if (random.chance(0.75)) {
    d.gain = random.log_between(0.4, 1.6);
    d.offset = random.between(-30.0, 30.0);
  }
  if (random.chance(0.3)) d.vignetting = random.between(0.0, 0.6);
  return d;
}

void blur_upright(int rows, int width, std::vector<std::uint8_t>& pixels) {
  const int height = static_cast<int>(pixels.size()) / width;
  std::vector<int> column(static_cast<std::size_t>(height) + 1);
  for (int x = 0; x < width; ++x) {
    for (int y = 0; y < height; ++y) column[y + 1] = column[y] + pixels[static_cast<std::size_t>(y) * width + x];
    for (int y = 0; y < height; ++y) {
      const int begin = std::max(0, y - rows / 2);
      const int end = std::min(height, begin + rows);
      pixels[static_cast<std::size_t>(y) * width + x] =
          static_cast<std::uint8_t>((column[end] - column[begin]) / (end - begin));
    }
  }
}

void darken_corners(double vignetting, int width, std::vector<std::uint8_t>& pixels) {
  const int height = static_cast<int>(pixels.size()) / width;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double right = 2.0 * x / width - 1.0;
      const double down = 2.0 * y / height - 1.0;
      auto& pixel = pixels[static_cast<std::size_t>(y) * width + x];
      pixel = static_cast<std::uint8_t>(pixel * (1.0 - 0.5 * vignetting * (right * right + down * down)));
    }
  }
}

void disturb(const Disturbance& d, int width, std::vector<std::uint8_t>& pixels) {
  if (d.blur_rows > 1) blur_upright(d.blur_rows, width, pixels);
  if (d.vignetting > 0.0) darken_corners(d.vignetting, width, pixels);
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

/// Position and attitude of the drone.
struct BodyPose {
  Vector3d p_WB_m;
  Eigen::Matrix3d R_WB;
};

/// Returns a drone with this position and heading. Pitch and roll are random, with a standard deviation of
/// `spread_rad`.
BodyPose tilted(Random& random, const Vector3d& p, double yaw, double spread_rad) {
  const Eigen::Matrix3d R =
      (AngleAxisd(yaw, Vector3d::UnitZ()) * AngleAxisd(random.normal(spread_rad), Vector3d::UnitY()) *
       AngleAxisd(random.normal(spread_rad), Vector3d::UnitX()))
          .toRotationMatrix();
  return {p, R};
}

BodyPose random_pose(Random& random, const mebots::world::scene::Scene& scene, double half_view_rad) {
  double yaw = random.between(-M_PI, M_PI);
  Vector3d p{random.between(-1.5, 4.0), random.between(-2.0, 2.0), 1.0 + random.normal(0.06)};
  if (!scene.gates.empty() && random.chance(0.9)) {
    const auto& gate = scene.gates[0];
    // Large distances are more frequent than in a uniform distribution of the logarithm, because these pictures contain
    // the least information.
    const double distance = random.chance(0.6) ? random.between(0.8, 7.5) : random.log_between(0.15, 2.0);
    const double off_axis = random.chance(0.5) ? random.normal(0.25) : random.between(-1.05, 1.05);
    const double towards = gate.yaw_rad + off_axis;
    p.head<2>() = gate.p_W_m.head<2>() - distance * Vector3d(std::cos(towards), std::sin(towards), 0.0).head<2>();
    p.z() = gate.p_W_m.z() - 0.03 + random.normal(0.06);
    const double bearing = random.chance(0.4) ? random.normal(0.12) : random.between(-1.1, 1.1) * half_view_rad;
    yaw = towards - bearing;
  }
  return tilted(random, p, yaw, 0.035);
}

/// Places a camera of the sight network so that the gate is in the picture or just outside of it.
void place_before(Random& random, const mebots::world::scene::Gate& gate, double half_view_rad, Vector3d& p,
                  double& yaw) {
  const double distance = random.chance(0.6) ? random.between(0.5, 7.5) : random.log_between(0.3, 2.5);
  const double off_axis = random.chance(0.6) ? random.normal(0.3) : random.between(-1.15, 1.15);
  const double towards = gate.yaw_rad + off_axis;
  p.head<2>() = gate.p_W_m.head<2>() - distance * Vector3d(std::cos(towards), std::sin(towards), 0.0).head<2>();
  const double away = random.chance(0.5) ? random.normal(0.08) : random.between(-0.45, 0.45);
  p.z() = std::max(0.3, gate.p_W_m.z() + away);
  const double bearing = random.chance(0.4) ? random.normal(0.15) : random.between(-1.15, 1.15) * half_view_rad;
  yaw = towards - bearing;
}

/// Returns a random position and attitude of the drone for the sight network. Compared with random_pose(), heights vary
/// more, the tilt is stronger, and more pictures contain no gate.
BodyPose random_view(Random& random, const mebots::world::scene::Scene& scene, double half_view_rad) {
  double yaw = random.between(-M_PI, M_PI);
  Vector3d p{random.between(-1.5, 4.0), random.between(-2.0, 2.0), random.between(0.5, 1.6)};
  if (!scene.gates.empty() && random.chance(0.82)) {
    const auto& gate = scene.gates[0];
    place_before(random, gate, half_view_rad, p, yaw);
  }
  return tilted(random, p, yaw, 0.045);
}

/// Returns the position of a random wall or object, for a camera that does not look at a gate.
Vector3d random_thing(Random& random, const mebots::world::scene::Scene& scene) {
  const int boxes = static_cast<int>(scene.boxes.size());
  const int cylinders = static_cast<int>(scene.cylinders.size());
  const int which = random.below(boxes + cylinders + static_cast<int>(scene.meshes.size()));
  if (which < boxes) return scene.boxes[static_cast<std::size_t>(which)].p_W_m;
  if (which < boxes + cylinders) return scene.cylinders[static_cast<std::size_t>(which - boxes)].p_W_m;
  return scene.meshes[static_cast<std::size_t>(which - boxes - cylinders)].p_W_m;
}

/// Returns a random position and attitude of the drone in a cluttered hall. The camera may look at any gate. Many
/// pictures contain no gate.
BodyPose view_of_clutter(Random& random, const mebots::world::scene::Scene& scene, double half_view_rad) {
  double yaw = random.between(-M_PI, M_PI);
  Vector3d p{random.between(-1.5, 4.0), random.between(-2.0, 2.0), random.between(0.5, 1.6)};
  const double what = random.unit();
  if (!scene.gates.empty() && what < 0.58) {
    const auto& gate = scene.gates[static_cast<std::size_t>(random.below(static_cast<int>(scene.gates.size())))];
    place_before(random, gate, half_view_rad, p, yaw);
  } else if (what < 0.92) {
    const Vector3d thing = random_thing(random, scene);
    const double distance = random.log_between(0.3, 6.0);
    const double towards = random.between(-M_PI, M_PI);
    p.head<2>() = thing.head<2>() - distance * Vector3d(std::cos(towards), std::sin(towards), 0.0).head<2>();
    yaw = towards - random.normal(0.5) * half_view_rad;
  }
  return tilted(random, p, yaw, 0.045);
}

/// Returns all objects that can hide a gate, as boxes. For cylinders, returns their bounding boxes.
std::vector<mebots::world::scene::Box> obstacles(const mebots::world::scene::Scene& scene) {
  auto boxes = scene.boxes;
  for (const auto& cylinder : scene.cylinders) {
    auto& box = boxes.emplace_back();
    box.p_W_m = cylinder.p_W_m;
    box.size_m = {2.0 * cylinder.radius_m, 2.0 * cylinder.radius_m, cylinder.height_m};
  }
  for (const auto& thing : scene.meshes) {
    Vector3d low = Vector3d::Constant(1e9);
    Vector3d high = -low;
    for (const auto& point : thing.mesh->points_m) {
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
    auto& box = boxes.emplace_back();
    box.p_W_m = thing.p_W_m + AngleAxisd(thing.yaw_rad, Vector3d::UnitZ()) * Vector3d(0.5 * (low + high));
    box.size_m = high - low;
    box.yaw_rad = thing.yaw_rad;
  }
  return boxes;
}

bool inside(const mebots::world::scene::Box& box, const Vector3d& p_W, double margin_m) {
  const Vector3d p = AngleAxisd(-box.yaw_rad, Vector3d::UnitZ()) * (p_W - box.p_W_m);
  return (p.cwiseAbs() - 0.5 * box.size_m).maxCoeff() < margin_m;
}

/// True if the drone can be at this position, and no object is between it and the gate.
bool free_view(const mebots::world::scene::Scene& scene, const Vector3d& p_W) {
  for (const auto& box : obstacles(scene)) {
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

/// True if the straight line between both points intersects the box.
bool meets(const mebots::world::scene::Box& box, const Vector3d& from_W, const Vector3d& to_W) {
  const AngleAxisd turn(-box.yaw_rad, Vector3d::UnitZ());
  const Vector3d from = turn * (from_W - box.p_W_m);
  const Vector3d step = turn * (to_W - from_W);
  double enter = 0.0;
  double leave = 1.0;
  for (int i = 0; i < 3; ++i) {
    const double half = 0.5 * box.size_m[i];
    if (std::abs(step[i]) < 1e-12) {
      if (std::abs(from[i]) > half) return false;
      continue;
    }
    const double one = (-half - from[i]) / step[i];
    const double other = (half - from[i]) / step[i];
    enter = std::max(enter, std::min(one, other));
    leave = std::min(leave, std::max(one, other));
  }
  return enter < leave;
}

/// Returns the share of a gate's frame that objects hide from a position. Only considers the middle of the beams.
double hidden_part(const std::vector<mebots::world::scene::Box>& things, const mebots::world::scene::Gate& gate,
                   const Vector3d& p_W) {
  return mebots::training::part_of_frame(gate, 0.5, [&](const Vector3d& point_W) {
    return std::any_of(things.begin(), things.end(), [&](const auto& box) { return meets(box, p_W, point_W); });
  });
}

/// The maximum hidden share of a gate that the sight network must detect.
constexpr double kMostHidden = 0.35;

/// True if the drone can be at this position, and at most kMostHidden of the gate is hidden.
bool has_answer(const mebots::world::scene::Scene& scene, const std::vector<mebots::world::scene::Box>& things,
                const Sight& seen, const Vector3d& p_W) {
  if (std::any_of(things.begin(), things.end(), [&](const auto& box) { return inside(box, p_W, 0.1); })) return false;
  if (seen.visibility == Visibility::none) return true;
  return hidden_part(things, scene.gates[static_cast<std::size_t>(seen.gate)], p_W) <= kMostHidden;
}

/// True if the point is in the room, at least 0.3 m from the outermost boxes, which are its walls.
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
  Writer(const std::string& out, Task task)
      : pictures_(out + ".pictures", std::ios::binary), labels_(out + ".labels.csv"), path_(out) {
    labels_ << (task == Task::sight ? "yaw,rise,size,visible,distance_m,field_of_view_rad,scene\n"
                                    : "yaw,visible,strength,distance_m,offset,field_of_view_rad,scene\n");
  }
  void add(const std::vector<std::int8_t>& picture, const Advice& advice, double field_of_view_rad, int scene) {
    write(picture);
    labels_ << fmt::format("{:.6f},{:d},{:.3f},{:.4f},{:.5f},{:.5f},{}\n", advice.yaw,
                           advice.visibility == Visibility::enough, advice.strength, advice.distance_m, advice.offset,
                           field_of_view_rad, scene);
  }
  void add(const std::vector<std::int8_t>& picture, const Sight& sight, double field_of_view_rad, int scene) {
    write(picture);
    labels_ << fmt::format("{:.6f},{:.6f},{:.5f},{:d},{:.4f},{:.5f},{}\n", sight.yaw, sight.rise, sight.size,
                           sight.visibility == Visibility::enough, sight.distance_m, field_of_view_rad, scene);
  }
  void finish() {
    if (!pictures_.flush() || !labels_.flush()) {
      throw mebots::Error(fmt::format("{}: cannot write; does its folder exist, is the disk full?", path_));
    }
  }

 private:
  void write(const std::vector<std::int8_t>& picture) {
    pictures_.write(reinterpret_cast<const char*>(picture.data()), static_cast<std::streamsize>(picture.size()));
  }

  std::ofstream pictures_;
  std::ofstream labels_;
  std::string path_;
};

/// The range of the field of view: from the lens of Webots' Crazyflie to the lens of Stargate's recordings.
constexpr double kNarrowest_rad = 0.87;
constexpr double kWidest_rad = 1.51844;

/// The range of the field of view for the sight network. It exceeds the range from kNarrowest_rad to kWidest_rad at
/// both ends.
constexpr double kNarrowestSight_rad = 0.82;
constexpr double kWidestSight_rad = 1.56;

mebots::world::camera::Intrinsics random_lens(const Options& options, Random& random) {
  mebots::world::camera::Intrinsics intrinsics;
  const bool sight = options.task == Task::sight;
  intrinsics.horizontal_field_of_view_rad =
      options.field_of_view_rad > 0.0
          ? options.field_of_view_rad
          : random.between(sight ? kNarrowestSight_rad : kNarrowest_rad, sight ? kWidestSight_rad : kWidest_rad);
  return intrinsics;
}

void take_pictures(const mebots::world::scene::Scene& scene, int scene_number, const Options& options, Random& random,
                   Writer& writer) {
  const bool sight = options.task == Task::sight;
  const auto intrinsics = random_lens(options, random);
  const double half_view_rad = 0.5 * intrinsics.horizontal_field_of_view_rad;
  const int count = options.pictures;
  mebots::world::camera::Renderer renderer(scene, intrinsics, random.between(0.0, sight ? 8.0 : 5.0));
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(intrinsics.width) * intrinsics.height);
  std::vector<std::int8_t> small(static_cast<std::size_t>(SHRUNK_EDGE) * SHRUNK_EDGE);
  std::array<std::uint16_t, SHRUNK_EDGE> columns{};
  shrink_columns(intrinsics.width, columns.data());
  const auto things = obstacles(scene);
  for (int taken = 0, tries = 0; taken < count && tries < 100 * count; ++tries) {
    const BodyPose pose = options.clutter ? view_of_clutter(random, scene, half_view_rad)
                          : sight         ? random_view(random, scene, half_view_rad)
                                          : random_pose(random, scene, half_view_rad);
    if (!in_room(scene, pose.p_WB_m)) continue;
    const auto camera = mebots::world::camera::camera_pose({}, pose.p_WB_m, pose.R_WB);
    const Advice advice = sight ? Advice{} : mebots::training::expert(scene, intrinsics, camera);
    const Sight seen = sight ? mebots::training::sight_of(scene, intrinsics, camera) : Sight{};
    if (advice.visibility == Visibility::sliver || seen.visibility == Visibility::sliver) continue;
    if (options.clutter ? !has_answer(scene, things, seen, pose.p_WB_m) : !free_view(scene, pose.p_WB_m)) continue;
    renderer.render(camera, random.word(), static_cast<std::uint64_t>(taken), pixels);
    disturb(sight ? strong_disturbance(random) : random_disturbance(random), intrinsics.width, pixels);
    for (int y = 0; y < SHRUNK_EDGE; ++y) {
      shrink_row(&pixels[static_cast<std::size_t>(shrink_place(y, intrinsics.height)) * intrinsics.width],
                 intrinsics.width, columns.data(), &small[static_cast<std::size_t>(y) * SHRUNK_EDGE]);
    }
    if (sight) {
      writer.add(small, seen, intrinsics.horizontal_field_of_view_rad, scene_number);
    } else {
      writer.add(small, advice, intrinsics.horizontal_field_of_view_rad, scene_number);
    }
    ++taken;
  }
}

mebots::world::scene::Scene room_of(const Options& options, Random& random) {
  if (!options.scene.empty()) return mebots::world::scene::load_scene(options.scene);
  return options.task == Task::sight ? mebots::training::random_hall(random, options.clutter)
                                     : mebots::training::random_room(random);
}

/// Ends the program if options contradict each other, before it writes a file.
void refuse_contradictions(const Options& options) {
  const char* why = nullptr;
  if (options.clutter && options.task != Task::sight) {
    why = "the task is command, whose rooms have no clutter. Add --task sight, or omit --clutter";
  } else if (options.clutter && !options.scene.empty()) {
    why = "clutter needs random rooms, but --scene names a fixed room. Omit one of the two options";
  }
  if (why == nullptr) return;
  fmt::print(stderr, "mebots-dataset: --clutter: {}\n", why);
  std::exit(2);
}

Options read_options(int argc, char** argv) {
  Options options;
  CLI::App app("Render pictures of random rooms with the labels for training");
  app.add_option("--out", options.out, "Path of the files to write, without their endings")->required();
  app.add_option("--task", options.task, "Content of the labels: the expert's yaw command, or the position of the gate")
      ->transform(
          CLI::CheckedTransformer(std::map<std::string, Task>{{"command", Task::command}, {"sight", Task::sight}}));
  app.add_option("--seed", options.seed, "Seed of the random rooms")->capture_default_str();
  app.add_option("--scenes", options.scenes, "Number of rooms")->check(CLI::Range(1, 1000000))->capture_default_str();
  app.add_option("--pictures", options.pictures, "Pictures of each room")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  app.add_option("--field-of-view", options.field_of_view_rad,
                 "Field of view of the lens [rad]; default: random in each room")
      ->check(CLI::Range(0.1, 3.0));
  app.add_flag("--clutter", options.clutter,
               "Add other objects to the random rooms. Needs --task sight, excludes --scene");
  app.add_option("--scene", options.scene, "A scene file instead of random rooms")->check(CLI::ExistingFile);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::exit(app.exit(error));
  }
  refuse_contradictions(options);
  return options;
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = read_options(argc, argv);
  try {
    Writer writer(options.out, options.task);
    for (int i = 0; i < options.scenes; ++i) {
      // Each room has its own random numbers, which do not depend on earlier rooms.
      Random random(options.seed * 1000003U + static_cast<std::uint64_t>(i));
      take_pictures(room_of(options, random), i, options, random, writer);
    }
    writer.finish();
  } catch (const mebots::Error& error) {
    fmt::print(stderr, "mebots-dataset: {}\n", error.what());
    return 1;
  }
  return 0;
}
