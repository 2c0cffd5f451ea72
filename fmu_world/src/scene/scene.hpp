// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/rotation.hpp"
#include "mebots/data/estimate.hpp"
#include "scene/mesh.hpp"
#include "scene/sensor_data.hpp"

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

/// Displacement and velocity of an object on a path at a time. The displacement is relative to the object's position in
/// the scene.
struct Displacement {
  Eigen::Vector3d offset_W_m = Eigen::Vector3d::Zero();
  double turn_rad = 0.0;  ///< about the vertical through the thing's own origin, positive to the left
  Eigen::Vector3d velocity_W_m_per_s = Eigen::Vector3d::Zero();
  double turn_rate_rad_per_s = 0.0;
};

/// The motion of an obstacle from point to point, at constant speed between two points. It depends only on time. At the
/// last point, the obstacle stops; with `repeat`, it starts again at the first point. Contacts do not affect it.
struct Path {
  struct Point {
    std::int64_t time_ns = 0;  ///< rising; the first one is 0
    Eigen::Vector3d offset_W_m = Eigen::Vector3d::Zero();
    double turn_rad = 0.0;
  };
  std::vector<Point> points;  ///< none: no motion; otherwise at least two
  bool repeat = false;

  bool moves() const { return !points.empty(); }
  /// Returns the greatest distance of a point of the path from the object's position in the scene.
  double reach_m() const;
  /// Returns the displacement at a time of the run. Times before the start have the displacement of the start.
  Displacement at(std::int64_t time_ns) const;
};

}  // namespace mebots::world::scene

/// The contents of the world as plain data in SI units, in the world frame W (x east, y north, z up). load_scene() in
/// load.hpp reads and checks them.
namespace mebots::world::scene {

/// The plane z = 0. It is unlimited for contacts. The camera draws it up to `half_size_m` from the origin in x and y.
struct Ground {
  double half_size_m = 10.0;  ///< > 0
  Texture texture;
};

/// A solid box, such as a wall, a pillar or a ramp. The origin of its frame is the box's centre. Its attitude is yaw
/// about z, then pitch about the new y, then roll about the new x.
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

/// A solid cylinder around the z axis of its frame. The camera draws 32 sides.
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

/// An object of triangles, from a file or generated.
struct MeshThing {
  std::string name;
  Eigen::Vector3d p_W_m = Eigen::Vector3d::Zero();  ///< of the mesh's origin
  double yaw_rad = 0.0;
  double pitch_rad = 0.0;
  double roll_rad = 0.0;
  std::shared_ptr<const Mesh> mesh;
  Path path = {};
};

template <typename Thing>
Eigen::Quaterniond attitude_of(const Thing& thing) {
  return rotation_of({thing.roll_rad, thing.pitch_rad, thing.yaw_rad});
}

/// A frame through which the drone flies. The origin of its frame of reference G is in the middle of the opening; x is
/// the direction of flight, y left, z up. Its attitude is yaw about z, then pitch about the new y, then roll about the
/// new x. A square or rectangular gate consists of four beams; the two vertical beams have the full outer height. A
/// circle is approximated by a polygon of 32 sides.
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
  /// Returns the number of sides of a frame without beams.
  int side_count() const { return shape == Shape::circle ? 32 : sides; }
  /// Returns the four beams as boxes in the world: left, right, top, bottom, as seen in the direction of flight.
  std::array<Box, 4> beams() const;
  /// Returns the mesh of a frame without beams, in the gate's frame of reference.
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

/// Constants of contact between the drone and all other objects, as ODE's manual defines them.
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

/// A row of the stabiliser's table of thrust over command.
struct ThrustPoint {
  double command = 0.0;   ///< duty cycle 0..1
  double thrust_n = 0.0;  ///< of one rotor
};

/// The drone's body, and the data of its stabiliser and sensors.
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
  double torque_per_thrust_m = 0.00735;                    ///< reaction torque over thrust in the stabiliser
  double rotor_lag_s = 0.1;                                ///< first-order lag of thrust in the stabiliser
  double start_command = 1.0;                              ///< greatest command when the motors start on the ground
  double start_time_s = 0.0;                               ///< time in which it rises to 1
  double range_limit_m = 4.0;                              ///< greatest distance of the range sensor
  std::vector<ThrustPoint> thrust_curve;                   ///< rising, from (0, 0) to the greatest command
  std::optional<RangeData> range;                          ///< absent: not in the drone's file
  std::optional<FlowData> flow;                            ///< absent: not in the drone's file
  std::optional<MultirangerData> multiranger;              ///< absent: not in the drone's file
  std::optional<BarometerData> barometer;                  ///< absent: not in the drone's file
  std::optional<MagnetometerData> magnetometer;            ///< absent: not in the drone's file
};

/// A robot other than a drone, such as a rover. It is a rigid body that stays upright. Its pose is an input. The parts
/// are in the robot's frame: x forward, y left, z up from the ground.
struct Robot {
  std::string name;
  std::vector<Box> boxes;
  std::vector<Cylinder> cylinders;
  std::vector<MeshThing> meshes;
};

struct Scene {
  std::string name;
  std::string text;
  Ground ground;
  std::vector<Box> boxes;
  std::vector<Cylinder> cylinders;
  std::vector<MeshThing> meshes;  ///< the terrain, if there is one, is the last
  std::vector<Gate> gates;        ///< in the order of flight; may be empty
  std::optional<Robot> robot;     ///< for robot.count robots
  Lighting lighting;
  StartPose start;
  Contact contact;
  Drone drone;
};

/// A solid for contacts and measurements of distance. The ground is not a Solid.
struct Solid {
  enum class Shape { box, cylinder, mesh };
  static constexpr std::size_t kNoGate = SIZE_MAX;

  Shape shape = Shape::box;
  std::string name;
  std::size_t gate = kNoGate;  ///< gate that it is part of
  Eigen::Vector3d p_W_m = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q_W = Eigen::Quaterniond::Identity();  ///< from its own axes to world axes
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();  ///< of a box: edges; of a cylinder: diameter, diameter, height
  std::shared_ptr<const Mesh> mesh;                  ///< of a mesh
  double radius_m = 0.0;                             ///< of a sphere around p_W_m that contains it
  Path path;
};

/// Returns boxes, cylinders, meshes and the parts of gates, each kind in the scene's order.
std::vector<Solid> solids_of(const Scene& scene);
/// Returns the robot's boxes, cylinders and meshes in its frame.
std::vector<Solid> solids_of(const Robot& robot);

}  // namespace mebots::world::scene
