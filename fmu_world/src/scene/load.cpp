// SPDX-License-Identifier: Apache-2.0
#include "scene/load.hpp"

#include "mebots/data/document.hpp"
#include "mebots/data/object.hpp"
#include "mebots/file_kind.hpp"
#include "mebots/png_file.hpp"
#include "scene/vector_reader.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

namespace mebots::world::scene {
namespace {

using data::Limits;
using data::Node;
using data::number;
using data::Object;

const Limits kUnit = Limits::between(0.0, 1.0);
const Limits kGrey = Limits::between(0.0, 255.0);
const Limits kTime_s = Limits::between(0.0, 1e6);

using File = std::filesystem::path;

/// Returns the path of a file that a scene names. A path without a slash at the start is relative to the scene's
/// folder.
auto file_in(const File& folder) {
  return [folder](const Node& node) {
    const auto text = node.readable_text();
    const auto file = (folder / text).lexically_normal();
    if (!is_there(file)) {
      node.fail(
          ErrorCode::file_not_found,
          fmt::format("there is no file '{}': the path is relative to the folder of this file, {}. Copy that file "
                      "as well, or give its whole path",
                      text, std::filesystem::absolute(folder).lexically_normal().string()));
    }
    return file;
  };
}

void read_picture(Object& object, Texture& texture, const File& folder) {
  texture.dark = 0.0;
  object.read("file", texture.picture,
              [&](const Node& member) { return std::make_shared<const Picture>(read_png(file_in(folder)(member))); });
  object.read("scale", texture.scale_m, number(Limits::positive()));
  object.read_if("light", texture.light, number(kGrey));
  object.read_if("dark", texture.dark, number(kGrey));
}

auto texture_in(const File& folder) {
  return [folder](const Node& node) {
    const auto kind = data::word_of<Texture::Kind>({{"uniform", Texture::Kind::uniform},
                                                    {"checker", Texture::Kind::checker},
                                                    {"stripes", Texture::Kind::stripes},
                                                    {"noise", Texture::Kind::noise},
                                                    {"bricks", Texture::Kind::bricks},
                                                    {"picture", Texture::Kind::picture}});
    Object object(node);
    Texture texture;
    texture.light = 255.0;
    object.read("kind", texture.kind, kind);
    if (texture.kind == Texture::Kind::picture) {
      read_picture(object, texture, folder);
    } else {
      object.read("light", texture.light, number(kGrey));
      texture.dark = texture.light;
      object.read_if("dark", texture.dark, number(kGrey));
      object.read_if("scale", texture.scale_m, number(Limits::positive()));
      object.read_if("seed", texture.seed, data::whole_number(0, std::numeric_limits<std::uint32_t>::max()));
    }
    object.finish();
    return texture;
  };
}

auto ground_in(const File& folder) {
  return [folder](const Node& node) {
    Object object(node);
    Ground ground;
    object.read("half_size", ground.half_size_m, number(Limits::positive()));
    object.read("texture", ground.texture, texture_in(folder));
    object.finish();
    return ground;
  };
}

Path::Point read_point(const Node& node) {
  Object object(node);
  Path::Point point;
  double time_s = 0.0;
  object.read("time", time_s, number(kTime_s));
  point.time_ns = std::llround(time_s * 1e9);
  object.read("offset", point.offset_W_m, vector<3>());
  object.read_if("turn", point.turn_rad, number());
  object.finish();
  return point;
}

/// Checks that a path has at least two points, that its times rise from 0, and that a repeated path ends where it
/// starts.
void check_path(const Node& node, const Path& path) {
  const auto points = node.at("points").elements();
  if (path.points.size() < 2) {
    node.at("points").fail(ErrorCode::invalid_value,
                           "a path needs two points or more; remove it from an object that does not move");
  }
  if (path.points.front().time_ns != 0)
    points[0].at("time").complain(ErrorCode::invalid_value, "a path begins at time 0");
  for (std::size_t i = 1; i < path.points.size(); ++i) {
    if (path.points[i].time_ns > path.points[i - 1].time_ns) continue;
    points[i].at("time").complain(ErrorCode::invalid_value, "each time must be greater than the one before");
  }
  if (!path.repeat) return;
  const Path::Point& first = path.points.front();
  const Path::Point& last = path.points.back();
  const double turns_rad = last.turn_rad - first.turn_rad;
  constexpr double kSameTurn_rad = 1e-3;
  if (last.offset_W_m != first.offset_W_m ||
      std::abs(std::remainder(turns_rad, 2.0 * std::numbers::pi)) > kSameTurn_rad) {
    points.back().complain(ErrorCode::invalid_value,
                           "a path that repeats must end where it begins: with the same offset, and a turn that "
                           "differs by a multiple of 2 pi");
  }
}

Path read_path(const Node& node) {
  Object object(node);
  Path path;
  object.read_if("repeat", path.repeat, &Node::flag);
  object.read("points", path.points, data::list_of(&read_point));
  object.finish();
  if (object.sound()) check_path(node, path);
  return path;
}

template <typename Thing>
void read_stand(Object& object, Thing& thing) {
  object.read("name", thing.name, &Node::text);
  object.read("position", thing.p_W_m, vector<3>());
  object.read_if("yaw", thing.yaw_rad, number());
  object.read_if("pitch", thing.pitch_rad, number());
  object.read_if("roll", thing.roll_rad, number());
  object.read_if("path", thing.path, &read_path);
}

auto box_in(const File& folder) {
  return [folder](const Node& node) {
    Object object(node);
    Box box;
    read_stand(object, box);
    object.read("size", box.size_m, vector<3>(Limits::positive()));
    object.read("texture", box.texture, texture_in(folder));
    object.finish();
    return box;
  };
}

auto cylinder_in(const File& folder) {
  return [folder](const Node& node) {
    Object object(node);
    Cylinder cylinder;
    read_stand(object, cylinder);
    object.read("radius", cylinder.radius_m, number(Limits::positive()));
    object.read("height", cylinder.height_m, number(Limits::positive()));
    object.read("texture", cylinder.texture, texture_in(folder));
    object.finish();
    return cylinder;
  };
}

auto mesh_in(const File& folder) {
  return [folder](const Node& node) {
    Object object(node);
    MeshThing thing;
    read_stand(object, thing);
    double scale = 1.0;
    object.read_if("scale", scale, number(Limits::positive()));
    auto mesh = std::make_shared<Mesh>();
    object.read("file", *mesh, [&](const Node& member) { return read_gltf(file_in(folder)(member), scale); });
    Texture texture;
    if (object.read_if("texture", texture, texture_in(folder))) {
      mesh->materials = {texture};
      for (auto& triangle : mesh->triangles) {
        triangle.material = 0;
        triangle.tiles.reset();
      }
    }
    thing.mesh = std::move(mesh);
    object.finish();
    return thing;
  };
}

using Heights = std::vector<std::vector<double>>;

Heights read_heights(const Node& node) {
  const auto rows = data::list_of(data::numbers(Limits::at_least(0.0)))(node);
  const auto elements = node.elements();
  if (rows.size() < 2 || rows.size() != elements.size()) {
    node.fail(ErrorCode::invalid_value, "at least two rows of numbers are needed");
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].size() < 2) elements[i].fail(ErrorCode::invalid_value, "at least two numbers are needed");
    if (rows[i].size() != rows[0].size()) {
      elements[i].fail(ErrorCode::invalid_value, fmt::format("this row has {} numbers, but the first row has {}",
                                                             rows[i].size(), rows[0].size()));
    }
  }
  return rows;
}

/// Converts a picture to the heights of a terrain. White is `height_m` high. The upper edge of the picture is north.
Heights heights_of(const Picture& picture, double height_m) {
  Heights heights(static_cast<std::size_t>(picture.height));
  for (int row = 0; row < picture.height; ++row) {
    const auto first = static_cast<std::size_t>(picture.height - 1 - row) * static_cast<std::size_t>(picture.width);
    for (int column = 0; column < picture.width; ++column) {
      heights[row].push_back(height_m * picture.grey[first + column] / 255.0);
    }
  }
  return heights;
}

auto terrain_in(const File& folder) {
  return [folder](const Node& node) {
    Object object(node);
    MeshThing terrain;
    terrain.name = "the terrain";
    Eigen::Vector2d corner = Eigen::Vector2d::Zero();
    double spacing_m = 1.0;
    double height_m = 0.0;
    Heights heights;
    Picture picture;
    Texture texture;
    object.read("position", corner, vector<2>());
    object.read("spacing", spacing_m, number(Limits::positive()));
    object.read("texture", texture, texture_in(folder));
    if (object.has("file")) {
      object.read("file", picture, [&](const Node& member) { return read_png(file_in(folder)(member)); });
      object.read("height", height_m, number(Limits::positive()));
      if (object.sound()) heights = heights_of(picture, height_m);
    } else {
      object.read("heights", heights, &read_heights);
    }
    object.finish();
    if (!object.sound()) return terrain;
    if (heights.size() < 2 || heights[0].size() < 2 ||
        2 * (heights.size() - 1) * (heights[0].size() - 1) > kMostTriangles) {
      node.fail(ErrorCode::invalid_value,
                fmt::format("a grid of {} x {} points; at least 2 x 2 points and at most {} squares are allowed",
                            heights[0].size(), heights.size(), kMostTriangles / 2));
    }
    terrain.p_W_m = {corner.x(), corner.y(), 0.0};
    terrain.mesh = std::make_shared<const Mesh>(height_field(heights, spacing_m, texture));
    return terrain;
  };
}

/// Returns a reader of [width, height] for a rectangle, and of one number for both edges of other shapes.
auto edge_of(Gate::Shape shape) {
  return [shape](const Node& node) {
    if (shape == Gate::Shape::rectangle) return Eigen::Vector2d(vector<2>(Limits::positive())(node));
    const double edge_m = node.number(Limits::positive());
    return Eigen::Vector2d(edge_m, edge_m);
  };
}

void read_gate_size(Object& object, Gate& gate) {
  const auto shape = data::word_of<Gate::Shape>({{"square", Gate::Shape::square},
                                                 {"rectangle", Gate::Shape::rectangle},
                                                 {"circle", Gate::Shape::circle},
                                                 {"polygon", Gate::Shape::polygon}});
  object.read_if("shape", gate.shape, shape);
  if (gate.shape == Gate::Shape::polygon) object.read("sides", gate.sides, data::whole_number(3, 64));
  Eigen::Vector2d inner_m{gate.inner_m, gate.inner_m};
  Eigen::Vector2d outer_m{gate.outer_m, gate.outer_m};
  object.read_if("inner", inner_m, edge_of(gate.shape));
  object.read_if("outer", outer_m, edge_of(gate.shape));
  object.read_if("thickness", gate.thickness_m, number(Limits::positive()));
  const Node& node = object.node();
  for (int i = 0; i < 2 && object.sound(); ++i) {
    if (outer_m[i] > inner_m[i]) continue;
    const auto wrong = node.find("outer").value_or(node.find("inner").value_or(node));
    wrong.complain(ErrorCode::invalid_value,
                   fmt::format("outer = {} must be greater than inner = {}", outer_m[i], inner_m[i]));
  }
  gate.inner_m = inner_m.x();
  gate.outer_m = outer_m.x();
  gate.inner_height_m = inner_m.y();
  gate.outer_height_m = outer_m.y();
}

auto gate_in(const File& folder) {
  return [folder](const Node& node) {
    Object object(node);
    Gate gate;
    object.read("name", gate.name, &Node::text);
    read_gate_size(object, gate);
    Eigen::Vector2d place = Eigen::Vector2d::Zero();
    double lower_edge_m = 0;
    object.read("position", place, vector<2>());
    object.read_if("yaw", gate.yaw_rad, number());
    object.read_if("pitch", gate.pitch_rad, number());
    object.read_if("roll", gate.roll_rad, number());
    const double border_m = 0.5 * (gate.frame_height_m() - gate.opening_height_m());
    object.read("opening_lower_edge", lower_edge_m, number(Limits::at_least(border_m)));
    gate.p_W_m = {place[0], place[1], lower_edge_m + 0.5 * gate.opening_height_m()};
    object.read("texture", gate.texture, texture_in(folder));
    object.finish();
    return gate;
  };
}

/// Reports each part of a robot that has its own path, because parts move only with their robot.
template <typename Part>
void refuse_paths(const Node& robot, const char* key, const std::vector<Part>& parts) {
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (!parts[i].path.moves()) continue;
    robot.at(key).elements()[i].at("path").complain(
        ErrorCode::invalid_value, "a part of a robot must not have a path, because it moves with the robot");
  }
}

auto robot_in(const File& folder) {
  return [folder](const Node& node) {
    Object object(node);
    Robot robot;
    object.read("name", robot.name, &Node::text);
    object.read_if("boxes", robot.boxes, data::list_of(box_in(folder)));
    object.read_if("cylinders", robot.cylinders, data::list_of(cylinder_in(folder)));
    object.read_if("meshes", robot.meshes, data::list_of(mesh_in(folder)));
    object.finish();
    if (!object.sound()) return robot;
    if (robot.boxes.empty() && robot.cylinders.empty() && robot.meshes.empty())
      node.fail(ErrorCode::invalid_value, "a robot needs a part: boxes, cylinders or meshes");
    refuse_paths(node, "boxes", robot.boxes);
    refuse_paths(node, "cylinders", robot.cylinders);
    refuse_paths(node, "meshes", robot.meshes);
    return robot;
  };
}

Lighting read_lighting(const Node& node) {
  Object object(node);
  Lighting lighting;
  object.read("ambient", lighting.ambient, number(Limits::at_least(0.0)));
  object.read("sun", lighting.sun, number(Limits::at_least(0.0)));
  object.read("to_sun", lighting.to_sun_W, [](const Node& member) {
    const Eigen::Vector3d to_sun = vector<3>()(member);
    if (to_sun.norm() < 1e-9) member.fail(ErrorCode::invalid_value, "this must not be the zero vector");
    return Eigen::Vector3d(to_sun.normalized());
  });
  object.read("background", lighting.background, number(kGrey));
  object.finish();
  return lighting;
}

StartPose read_start(const Node& node) {
  Object object(node);
  StartPose start;
  object.read("position", start.p_WB_m, vector<3>());
  object.read_if("yaw", start.yaw_rad, number());
  object.finish();
  return start;
}

Contact read_contact(const Node& node) {
  Object object(node);
  Contact contact;
  object.read("friction", contact.friction, number(Limits::at_least(0.0)));
  object.read("bounce", contact.bounce, number(kUnit));
  object.read("bounce_speed", contact.bounce_speed_m_per_s, number(Limits::at_least(0.0)));
  object.read("soft_erp", contact.soft_erp, number(kUnit));
  object.read("soft_cfm", contact.soft_cfm, number(Limits::at_least(0.0)));
  object.read("erp", contact.erp, number(kUnit));
  object.read("cfm", contact.cfm, number(Limits::at_least(0.0)));
  object.read("crash_speed", contact.crash_speed_m_per_s, number(Limits::positive()));
  object.read("crash_tilt", contact.crash_tilt_rad, number({0.0, 3.1416, false}));
  object.comment("source");
  object.finish();
  return contact;
}

Scene read_scene(const Node& node, const File& folder) {
  Object object(node);
  Scene scene;
  object.comment("$schema");
  object.read("name", scene.name, &Node::text);
  object.read("text", scene.text, &Node::text);
  object.read("drone", scene.drone, [&](const Node& member) { return load_drone(file_in(folder)(member)); });
  object.read("start", scene.start, &read_start);
  object.read("ground", scene.ground, ground_in(folder));
  object.read("boxes", scene.boxes, data::list_of(box_in(folder)));
  object.read_if("cylinders", scene.cylinders, data::list_of(cylinder_in(folder)));
  object.read_if("meshes", scene.meshes, data::list_of(mesh_in(folder)));
  MeshThing terrain;
  if (object.read_if("terrain", terrain, terrain_in(folder))) scene.meshes.push_back(terrain);
  object.read("gates", scene.gates, data::list_of(gate_in(folder)));
  object.visit_if("robot", [&](const Node& section) { scene.robot = robot_in(folder)(section); });
  object.read("lighting", scene.lighting, &read_lighting);
  object.read("contact", scene.contact, &read_contact);
  object.finish();
  return scene;
}

}  // namespace

Scene load_scene(const std::filesystem::path& file) {
  return data::Document(file).read([&](const Node& root) { return read_scene(root, file.parent_path()); });
}

}  // namespace mebots::world::scene
