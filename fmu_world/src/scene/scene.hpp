// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

/// What stands in the world, as a scene file tells it: plain data, SI units, world frame W
/// (x east, y north, z up). Read and checked by load_scene() in load.hpp.
namespace mebots::world::scene {

/// How a surface reflects. Grey levels are 0 (black) to 255 (white) as the camera sees the surface
/// under a light of 1.
struct Texture {
  enum class Kind {
    uniform,  ///< `light` everywhere
    checker,  ///< squares of edge `scale_m`, alternating
    stripes,  ///< bands of width `scale_m` across the surface's first axis, alternating
    noise,    ///< smooth value noise between `dark` and `light`, lattice of `scale_m`
    bricks,   ///< `light` bricks 2 scale_m x scale_m, every second row shifted by half, joints `dark`
  };
  Kind kind = Kind::uniform;
  double light = 200.0;    ///< grey level, 0..255
  double dark = 100.0;     ///< grey level, 0..255
  double scale_m = 0.5;    ///< size of the pattern's element, > 0
  std::uint32_t seed = 0;  ///< of `noise`, and of the small differences between bricks

  bool operator==(const Texture&) const = default;
};

/// The plane z = 0, endless for contact; the camera may stop drawing it at `half_size_m`.
struct Ground {
  double half_size_m = 10.0;  ///< > 0
  Texture texture;
};

/// An upright solid box that never moves: a wall, a pillar, a table. Its frame has the box's centre as
/// origin and is turned by `yaw_rad` about z.
struct Box {
  std::string name;
  Eigen::Vector3d p_W_m = Eigen::Vector3d::Zero();   ///< centre
  Eigen::Vector3d size_m = Eigen::Vector3d::Ones();  ///< full edge lengths along its own x, y, z, > 0
  double yaw_rad = 0.0;
  Texture texture;
};

/// A square frame to fly through. Gate frame G: origin in the middle of the opening, x along the
/// direction in which it is to be flown, y left, z up.
/// Made of four beams; the two upright ones reach over the full outer height.
struct Gate {
  std::string name;
  Eigen::Vector3d p_W_m = Eigen::Vector3d::Zero();  ///< middle of the opening
  double yaw_rad = 0.0;                             ///< of the flight direction
  double inner_m = 0.40;                            ///< edge of the opening
  double outer_m = 0.60;                            ///< edge of the frame
  double thickness_m = 0.03;                        ///< along x
  Texture texture;

  /// The four beams as boxes in the world: left, right, top, bottom as flown.
  std::array<Box, 4> beams() const;
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

/// The drone as a body and what its stabiliser knows of it.
struct Drone {
  std::string name;
  Eigen::Vector3d body_size_m{0.092, 0.092, 0.029};  ///< contact box, centred at the body frame's origin
  double reference_mass_kg = 0.028;                  ///< mass for which `inertia_kg_m2` holds
  Eigen::Vector3d inertia_kg_m2{16.57171e-6, 16.655602e-6, 29.261652e-6};  ///< principal, about body axes
  Eigen::Vector3d load_size_m{0.032, 0.028, 0.02};         ///< box over which mass beyond the reference is spread
  double arm_m = 0.03253;                                  ///< rotor distance from the centre along x and along y
  Eigen::Vector3d drag_n_s_per_m{0.0147, 0.0147, 0.0128};  ///< linear drag along body axes
  double torque_per_thrust_m = 0.00735;                    ///< reaction torque over thrust that the stabiliser expects
  double rotor_lag_s = 0.1;                                ///< first-order lag of thrust that the stabiliser expects
  double range_limit_m = 4.0;                              ///< farthest distance that the range sensor sees
  std::vector<ThrustPoint> thrust_curve;                   ///< rising, from (0, 0) to the greatest command
};

struct Scene {
  std::string name;
  std::string text;
  Ground ground;
  std::vector<Box> boxes;
  std::vector<Gate> gates;  ///< in the order in which they are to be flown; may be empty
  Lighting lighting;
  StartPose start;
  Contact contact;
  Drone drone;
};

}  // namespace mebots::world::scene
