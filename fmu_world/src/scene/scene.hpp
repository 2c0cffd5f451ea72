// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/rotation.hpp"
#include "mebots/data/estimate.hpp"
#include "scene/mesh.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace mebots::world::scene {

/// Where a thing on a path is at a time, seen from where it stands without one, and how fast it goes.
struct Displacement {
  Eigen::Vector3d offset_W_m = Eigen::Vector3d::Zero();
  double turn_rad = 0.0;  ///< about the vertical through the thing's own origin, positive to the left
  Eigen::Vector3d velocity_W_m_per_s = Eigen::Vector3d::Zero();
  double turn_rate_rad_per_s = 0.0;
};

/// How an obstacle moves: at even speed from point to point, a function of time alone, so that it has no state.
/// After the last point it stays there, or begins again when it repeats. Nothing stops it: it has any strength.
struct Path {
  struct Point {
    std::int64_t time_ns = 0;  ///< rising; the first one is 0
    Eigen::Vector3d offset_W_m = Eigen::Vector3d::Zero();
    double turn_rad = 0.0;
  };
  std::vector<Point> points;  ///< none: it stands still; otherwise at least two
  bool repeat = false;

  bool moves() const { return !points.empty(); }
  /// Farthest offset.
  double reach_m() const;
  /// At a time from the start of the run; before it as at it.
  Displacement at(std::int64_t time_ns) const;
};

}  // namespace mebots::world::scene

/// What stands in the world, as a scene file tells it: plain data, SI units, world frame W
/// (x east, y north, z up). Read and checked by load_scene() in load.hpp.
namespace mebots::world::scene {

/// The plane z = 0, endless for contact; the camera may stop drawing it at `half_size_m`.
struct Ground {
  double half_size_m = 10.0;  ///< > 0
  Texture texture;
};

/// A solid box: a wall, a pillar, a ramp. Its frame has the box's centre as origin and is turned by yaw about z, then
/// pitch about its y, then roll about its x, as the drone's.
struct Box {
  std::string name;
  Eigen::Vector3d p_W_m = Eigen::Vector3d::Zero();   ///< centre
  Eigen::Vector3d size_m = Eigen::Vector3d::Ones();  ///< full edge lengths along its own x, y, z, > 0
  double yaw_rad = 0.0;
  Texture texture;
  double pitch_rad = 0.0;
  double roll_rad = 0.0;
  Path path = {};
};

/// A solid cylinder round its own z. The camera and whoever draws it see one of 32 sides.
struct Cylinder {
  std::string name;
  Eigen::Vector3d p_W_m = Eigen::Vector3d::Zero();  ///< centre
  double radius_m = 0.5;                            ///< > 0
  double height_m = 1.0;                            ///< > 0
  double yaw_rad = 0.0;
  double pitch_rad = 0.0;
  double roll_rad = 0.0;
  Texture texture;
  Path path = {};
};

/// A thing of triangles, from a file or made here.
struct MeshThing {
  std::string name;
  Eigen::Vector3d p_W_m = Eigen::Vector3d::Zero();  ///< of the mesh's origin
  double yaw_rad = 0.0;
  double pitch_rad = 0.0;
  double roll_rad = 0.0;
  std::shared_ptr<const Mesh> mesh;
  Path path = {};
};

/// How a thing is turned: its own axes into world axes.
template <typename Thing>
Eigen::Quaterniond attitude_of(const Thing& thing) {
  return rotation_of({thing.roll_rad, thing.pitch_rad, thing.yaw_rad});
}

/// A frame to fly through. Gate frame G: origin in the middle of the opening, x along the direction in which it is to
/// be flown, y left, z up; turned as a box is. A square or a rectangle is made of four beams; the two upright ones
/// reach over the full outer height. A circle is made, seen and judged as a polygon of 32 sides.
struct Gate {
  enum class Shape { square, rectangle, circle, polygon };

  std::string name;
  Eigen::Vector3d p_W_m = Eigen::Vector3d::Zero();  ///< middle of the opening
  double yaw_rad = 0.0;                             ///< of the flight direction
  double inner_m = 0.40;                            ///< edge of the opening; from side to side of a polygon
  double outer_m = 0.60;                            ///< edge of the frame; from side to side of a polygon
  double thickness_m = 0.03;                        ///< along x
  Texture texture;
  Shape shape = Shape::square;
  double inner_height_m = 0.0;  ///< of a rectangle, whose width is `inner_m`
  double outer_height_m = 0.0;
  int sides = 4;  ///< of a polygon
  double pitch_rad = 0.0;
  double roll_rad = 0.0;

  bool has_beams() const { return shape == Shape::square || shape == Shape::rectangle; }
  double opening_height_m() const { return shape == Shape::rectangle ? inner_height_m : inner_m; }
  double frame_height_m() const { return shape == Shape::rectangle ? outer_height_m : outer_m; }
  /// Of a frame that has no beams.
  int side_count() const { return shape == Shape::circle ? 32 : sides; }
  /// The four beams as boxes in the world: left, right, top, bottom as flown.
  std::array<Box, 4> beams() const;
  /// The frame of one that has no beams, in the gate's frame.
  Mesh frame() const { return ring(side_count(), inner_m, outer_m, thickness_m, texture); }
};

struct Lighting {
  double ambient = 0.5;  ///< light on every surface, >= 0
  double sun = 0.5;      ///< light added on a surface that faces the sun, times the cosine, >= 0
  Eigen::Vector3d to_sun_W = Eigen::Vector3d::UnitZ();  ///< unit vector from the world to the sun
  double background = 230.0;                            ///< grey level where nothing stands
};

struct StartPose {
  Eigen::Vector3d p_WB_m = Eigen::Vector3d::Zero();
  double yaw_rad = 0.0;
};

/// Constants of contact between the drone and everything else. Meanings as in ODE's manual.
struct Contact {
  double friction = 1.0;               ///< Coulomb coefficient mu, >= 0
  double bounce = 0.5;                 ///< restitution, 0..1
  double bounce_speed_m_per_s = 0.01;  ///< closing speed below which nothing bounces
  double soft_erp = 0.2;               ///< 0..1
  double soft_cfm = 0.001;             ///< >= 0
  double erp = 0.2;                    ///< of the world, 0..1
  double cfm = 1e-5;                   ///< of the world, >= 0
  double crash_speed_m_per_s = 1.0;    ///< closing speed along the contact normal from which it is a crash
  double crash_tilt_rad = 1.309;       ///< angle between body z and world z from which it is a crash
};

/// One row of the command-thrust curve that the stabiliser believes in.
struct ThrustPoint {
  double command = 0.0;   ///< duty cycle 0..1
  double thrust_n = 0.0;  ///< of one rotor
};

/// What a time-of-flight sensor with a field of view tells: the nearest surface in its cone, at `period`.
/// Standard deviation: near_noise (1 + (far_noise / near_noise)^((d - near) / (far - near))).
struct RangeData {
  double field_of_view_rad = 0.0;  ///< angle of the whole cone
  double period_s = 0.0;
  double resolution_m = 0.0;
  double near_m = 0.0;
  double near_noise_m = 0.0;
  double far_m = 0.0;
  double far_noise_m = 0.0;
};

/// An optical flow sensor: how far its picture of the surface below moves in each period.
struct FlowData {
  double pixels_per_rad = 0.0;  ///< of motion in the middle of the picture
  double period_s = 0.0;
  double resolution_pixels = 0.0;  ///< one count
  double noise_pixels = 0.0;       ///< standard deviation of a sample
  double nearest_m = 0.0;          ///< nearer surfaces are not seen
  double fastest_rad_per_s = 0.0;  ///< faster motion is not seen
};

/// The drone as a body and what its stabiliser knows of it.
struct Drone {
  std::string name;
  Eigen::Vector3d body_size_m{0.092, 0.092, 0.029};  ///< contact box, centred at the body frame's origin
  double reference_mass_kg = 0.028;                  ///< mass for which `inertia_kg_m2` holds
  Eigen::Vector3d inertia_kg_m2{16.57171e-6, 16.655602e-6, 29.261652e-6};  ///< principal, about body axes
  Eigen::Vector3d load_size_m{0.032, 0.028, 0.02};         ///< box over which mass beyond the reference is spread
  double arm_m = 0.03253;                                  ///< rotor distance from the centre along x and along y
  Eigen::Vector3d drag_n_s_per_m{0.0147, 0.0147, 0.0128};  ///< linear drag along body axes
  data::Estimate drag_factor{1, {}};                       ///< multiplies the drag
  data::Estimate dry_mass_factor{1, {}};                   ///< multiplies the mass without the cell
  double torque_per_thrust_m = 0.00735;                    ///< reaction torque over thrust that the stabiliser expects
  double rotor_lag_s = 0.1;                                ///< first-order lag of thrust that the stabiliser expects
  double start_command = 1.0;                              ///< greatest command when the motors start on the ground
  double start_time_s = 0.0;                               ///< it rises to 1 in this time
  double range_limit_m = 4.0;                              ///< farthest distance that the range sensor sees
  std::vector<ThrustPoint> thrust_curve;                   ///< rising, from (0, 0) to the greatest command
  std::optional<RangeData> range;                          ///< absent: the drone's file does not tell
  std::optional<FlowData> flow;                            ///< likewise
};

struct Scene {
  std::string name;
  std::string text;
  Ground ground;
  std::vector<Box> boxes;
  std::vector<Cylinder> cylinders;
  std::vector<MeshThing> meshes;  ///< the terrain, if there is one, comes last
  std::vector<Gate> gates;        ///< in the order in which they are to be flown; may be empty
  Lighting lighting;
  StartPose start;
  Contact contact;
  Drone drone;
};

/// What there is to touch and to measure the distance to, besides the ground: one list of all shapes.
struct Solid {
  enum class Shape { box, cylinder, mesh };
  static constexpr std::size_t kNoGate = SIZE_MAX;

  Shape shape = Shape::box;
  std::string name;
  std::size_t gate = kNoGate;  ///< that it belongs to
  Eigen::Vector3d p_W_m = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q_W = Eigen::Quaterniond::Identity();  ///< its own axes into world axes
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();  ///< of a box: edges; of a cylinder: diameter, diameter, height
  std::shared_ptr<const Mesh> mesh;                  ///< of a mesh
  double radius_m = 0.0;                             ///< of a sphere round p_W_m that holds it
  Path path;
};

/// Boxes, cylinders, meshes, then the parts of gates, each kind in the scene's order.
std::vector<Solid> solids_of(const Scene& scene);

}  // namespace mebots::world::scene
