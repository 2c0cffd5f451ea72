// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dynamics/airframe.hpp"
#include "mebots/state/visitor.hpp"
#include "scene/scene.hpp"

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace mebots::world {

/// The position and orientation of a gate. Gate frame G: origin in the middle of the opening, x in the direction of
/// flight, y left, z up.
struct GateFrame {
  explicit GateFrame(const scene::Gate& gate);

  Eigen::Vector3d in_gate(const Eigen::Vector3d& p_W_m) const { return R_WG.transpose() * (p_W_m - p_WG_m); }

  /// Both functions expect a point of the gate's plane in the gate's coordinates. The outline is the outer edge of the
  /// gate's frame.
  bool within_opening(const Eigen::Vector3d& p_G_m) const { return within(p_G_m, inner_m); }
  bool within_outline(const Eigen::Vector3d& p_G_m) const { return within(p_G_m, outer_m); }

  Eigen::Vector3d p_WG_m;
  Eigen::Matrix3d R_WG;
  Eigen::Vector2d inner_m;  ///< width and height of the opening
  Eigen::Vector2d outer_m;  ///< outer width and height of the gate's border
  double thickness_m;       ///< thickness of the border along x
  /// For a polygon: y and z of the outward normals of its sides. All sides have the same distance from the centre.
  std::vector<Eigen::Vector2d> sides;

 private:
  bool within(const Eigen::Vector3d& p_G_m, const Eigen::Vector2d& size_m) const;
};

struct GateEvent {
  enum class Kind {
    crossed,      ///< the drone's centre crossed the gate's plane in the opening
    missed,       ///< the drone's centre crossed the gate's plane outside the opening
    turned_back,  ///< after a crossing, the whole drone is in front of the gate again
    touched,      ///< the first touch of a contact with the gate
    stuck,        ///< the drone hangs on the gate, or has landed in it
  };
  Kind kind = Kind::crossed;
  std::size_t gate = 0;
  double lateral_m = 0.0;   ///< at a crossing: distance to the left of the opening's middle, as flown
  double vertical_m = 0.0;  ///< at a crossing: height above the opening's middle
};

/// Judges whether the drone flies through the gates in the order of the scene.
///
///   before --the centre crosses the plane forwards, inside the opening--> crossed
///   crossed --the whole drone is in front of the frame again--> before
///
/// The plane is in the middle of the frame's thickness. The opening's border belongs to the opening. "The whole drone"
/// is its contact box. Along the gate's x axis n, the box extends e = (|n.x_B| l_x + |n.y_B| l_y + |n.z_B| l_z) / 2 to
/// both sides of its centre, where l are the box's edges. If the box's centre is at x along n, the box is before the
/// gate for x + e <= -thickness / 2, and after the gate for x - e >= thickness / 2. Between these two positions, the
/// drone cannot leave the opening sideways. Therefore several passages of the centre through the plane count as one
/// crossing.
///
/// The way to the next gate may lead around a gate. Therefore a crossing becomes invalid only if the drone flies back
/// through the gate's frame before it crosses the next gate. The flight must end after the last gate, so the crossing
/// of the last gate becomes invalid whenever the whole drone returns to the front of the gate.
class GateJudge {
 public:
  /// `gates` are in the order of the scene. `body_size_m` contains the edges of the drone's contact box along its body
  /// axes.
  GateJudge(std::vector<GateFrame> gates, const Eigen::Vector3d& body_size_m);

  /// Judges a straight motion from one state to another. Returns the event at a gate; empty if no event occurred.
  std::optional<GateEvent> move(const RigidState& from, const RigidState& to);

  /// Judges a touch of a gate. Touches at most half a second apart belong to one contact. After a contact of ten
  /// seconds, the drone is stuck. The limit permits the slowest flight of examples/paper, which slides through a frame
  /// for 6 s.
  std::optional<GateEvent> touch(std::size_t gate, std::int64_t time_ns);

  /// Judges a landing. The drone is stuck if it rests on a gate, or if it has crossed the last gate and rests in its
  /// plane.
  std::optional<GateEvent> land(const RigidState& at, std::int64_t time_ns);

  /// True if every gate was crossed at some time, in the order of the scene.
  bool crossed() const { return crossed_; }
  /// True if every gate is crossed, and the whole drone is beyond the last gate.
  bool passed() const { return behind_; }
  bool touched() const { return touched_; }
  bool missed() const { return missed_; }
  bool turned_back() const { return turned_back_; }
  bool stuck() const { return stuck_; }
  /// True if the drone has crossed the plane of a gate. Otherwise lateral_error_m() is not valid.
  bool reached() const { return reached_; }
  double lateral_error_m() const { return lateral_error_m_; }
  /// Returns the distance from a point to the plane of the next gate, or of the last gate if all gates are crossed. The
  /// distance is negative beyond the plane. In a scene without gates, the distance is 0.
  double distance_m(const Eigen::Vector3d& p_W_m) const;

  /// Throws mebots::Error if the number of gates in a restored state differs from the scene.
  void visit(state::Visitor& v);

 private:
  struct Contact {
    std::int64_t since_ns;
    std::int64_t last_ns;

    void visit(state::Visitor& v) {
      v("since_ns", since_ns);
      v("last_ns", last_ns);
    }
  };

  bool whole_drone_in_front(const GateFrame& gate, const RigidState& state) const;
  bool whole_drone_behind(const GateFrame& gate, const RigidState& state) const;
  /// Returns the distance that the drone extends from its centre along the gate's x axis.
  double reach_m(const GateFrame& gate, const RigidState& state) const;
  bool crossed_all() const { return !gates_.empty() && next_ == gates_.size(); }
  bool crosses_back(const RigidState& from, const RigidState& to) const;
  std::optional<GateEvent> cross(const RigidState& from, const RigidState& to);
  std::optional<GateEvent> get_stuck(std::size_t gate);

  std::vector<GateFrame> gates_;
  Eigen::Vector3d body_size_m_;

  std::uint64_t next_ = 0;  ///< index of the next gate to be crossed
  bool crossed_ = false;    ///< true if all gates were crossed at some time
  bool behind_ = false;
  bool touched_ = false;
  bool missed_ = false;
  bool turned_back_ = false;
  bool stuck_ = false;
  bool reached_ = false;
  double lateral_error_m_ = 0.0;
  std::vector<Contact> contacts_;  ///< last contact with each gate, by index
};

}  // namespace mebots::world
