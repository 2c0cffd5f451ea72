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

/// Contains the position and orientation of a gate. Gate frame G: origin in the middle of the opening, x in the
/// direction of flight, y left, z up.
struct GateFrame {
  explicit GateFrame(const scene::Gate& gate);

  /// Converts a point from world coordinates to the gate's coordinates.
  Eigen::Vector3d in_gate(const Eigen::Vector3d& p_W_m) const { return R_WG.transpose() * (p_W_m - p_WG_m); }

  /// These functions return whether a point of the gate's plane, in the gate's coordinates, is in the opening, or in
  /// the outline of its border.
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

/// Describes an event at a gate, for the flight's log.
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

/// Judges whether the drone flies through the gates in the scene's order.
///
///   before --the centre crosses the plane forwards, inside the opening--> crossed
///   crossed --the whole drone is in front of the frame again--> before
///
/// The plane is the middle of the frame's thickness. The opening's border belongs to the opening. "The whole drone" is
/// its contact box. Along the gate's x axis n, the box extends e = (|n.x_B| l_x + |n.y_B| l_y + |n.z_B| l_z) / 2 to
/// both sides of its centre, where l are the box's edges. The box is before the gate if x + e <= -thickness / 2, and
/// after it if x - e >= thickness / 2. Between these two positions, the drone cannot leave the opening sideways. So a
/// drone that moves back and forth in the plane crosses only once.
///
/// The way to the next gate may lead around a gate. Therefore a crossing only becomes invalid if the drone flies back
/// through the gate's frame while the next gate is not crossed yet. A crossing of the last gate becomes invalid at any
/// return before its plane, because the flight must end after the gate.
class GateJudge {
 public:
  /// Creates a judge for the gates in the order of the scene. `body_size_m` contains the edges of the drone's contact
  /// box along its body axes.
  GateJudge(std::vector<GateFrame> gates, const Eigen::Vector3d& body_size_m);

  /// Judges a straight motion from one state to the next. Returns the event at a gate, if there is one.
  std::optional<GateEvent> move(const RigidState& from, const RigidState& to);

  /// Judges a touch of a gate. Touches at most half a second apart belong to one contact. After a contact of ten
  /// seconds, the drone is stuck. Reason: the slowest flight of examples/paper slides through a frame for 6 s.
  std::optional<GateEvent> touch(std::size_t gate, std::int64_t time_ns);

  /// Judges a landing. The drone is stuck if it rests on a gate, or in the plane of the last gate after crossing it.
  std::optional<GateEvent> land(const RigidState& at, std::int64_t time_ns);

  /// Returns true if every gate was crossed at some time, in their order.
  bool crossed() const { return crossed_; }
  /// Returns true if every gate is crossed, and the whole drone is beyond the last one.
  bool passed() const { return behind_; }
  bool touched() const { return touched_; }
  bool missed() const { return missed_; }
  bool turned_back() const { return turned_back_; }
  bool stuck() const { return stuck_; }
  /// Returns true if the drone has crossed the plane of a gate. The lateral error is valid only in this case.
  bool reached() const { return reached_; }
  double lateral_error_m() const { return lateral_error_m_; }
  /// Returns the distance from a point to the plane of the next gate. After the crossing of the last gate, returns the
  /// distance to the plane of the last gate. The distance is negative beyond the plane. In a scene without gates, it is
  /// 0.
  double distance_m(const Eigen::Vector3d& p_W_m) const;

  /// Visits the state. Throws mebots::Error if a restored state has another number of gates than the scene.
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
  /// Returns how far the drone extends from its centre along the gate's x axis.
  double reach_m(const GateFrame& gate, const RigidState& state) const;
  /// Returns true if all gates are crossed.
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
