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

/// Where a gate stands, however it is turned. Gate frame G: origin in the middle of the opening, x along the direction
/// in which it is to be flown, y left, z up.
struct GateFrame {
  explicit GateFrame(const scene::Gate& gate);

  /// A point of the world, seen from the gate.
  Eigen::Vector3d in_gate(const Eigen::Vector3d& p_W_m) const { return R_WG.transpose() * (p_W_m - p_WG_m); }

  /// Whether a point of the gate's plane, in its frame, lies in the opening, or in what the frame's outline holds.
  bool within_opening(const Eigen::Vector3d& p_G_m) const { return within(p_G_m, inner_m); }
  bool within_outline(const Eigen::Vector3d& p_G_m) const { return within(p_G_m, outer_m); }

  Eigen::Vector3d p_WG_m;
  Eigen::Matrix3d R_WG;
  Eigen::Vector2d inner_m;  ///< width and height of the opening
  Eigen::Vector2d outer_m;  ///< of the frame
  double thickness_m;       ///< along x
  /// Of a polygon: y and z of its sides' outward normals, all as far from the middle as the bottom one.
  std::vector<Eigen::Vector2d> sides;

 private:
  bool within(const Eigen::Vector3d& p_G_m, const Eigen::Vector2d& size_m) const;
};

/// Something about a gate that the flight's log should tell.
struct GateEvent {
  enum class Kind {
    crossed,      ///< its plane, through the opening
    missed,       ///< its plane was crossed outside of the opening
    turned_back,  ///< the drone is in front of it again
    touched,      ///< the first of touches that follow each other
    stuck,        ///< hangs on it, or has landed in it
  };
  Kind kind = Kind::crossed;
  std::size_t gate = 0;
  double lateral_m = 0.0;   ///< of a crossing: left of the opening's middle, as flown
  double vertical_m = 0.0;  ///< of a crossing: above it
};

/// Watches the drone go through the gates, in the scene's order, and knows whether it really did.
///
///   before --the centre crosses the plane forwards, inside the opening--> crossed
///   crossed --the whole drone is in front of the frame again--> before
///
/// The plane is the middle of the frame's thickness; the opening's border belongs to the opening. "The whole drone" is
/// its contact box. Seen from the gate, it reaches e = (|n.x_B| l_x + |n.y_B| l_y + |n.z_B| l_z) / 2 to both sides of
/// its centre, with n the gate's x axis and l the box's edges. It is in front when x + e <= -thickness / 2, and behind
/// when x - e >= thickness / 2. In between it cannot leave the opening sideways, so that a drone that trembles to
/// and fro in the plane neither crosses twice nor comes back.
///
/// A course may lead round a gate, so a gate is taken back by coming back through its frame, while the next one is
/// still to be crossed. The last gate is taken back by coming back anywhere: the flight has to end behind it.
class GateJudge {
 public:
  /// `body_size_m`: edges of the drone's contact box along its body axes.
  GateJudge(std::vector<GateFrame> gates, const Eigen::Vector3d& body_size_m);

  /// The drone went straight from one state to the other.
  std::optional<GateEvent> move(const RigidState& from, const RigidState& to);

  /// The drone touches a gate. Touches less than half a second apart are one contact. A contact of ten seconds is not
  /// a skid (the slowest of the paper's flights slides through a frame in 6 s): the drone is stuck.
  std::optional<GateEvent> touch(std::size_t gate, std::int64_t time_ns);

  /// The drone has landed. It is stuck if it rests on a gate, or in the plane of the last one after crossing it.
  std::optional<GateEvent> land(const RigidState& at, std::int64_t time_ns);

  /// Every gate was crossed, in their order; stays so.
  bool crossed() const { return crossed_; }
  /// Every gate is crossed, and the whole drone is behind the last one.
  bool passed() const { return behind_; }
  bool touched() const { return touched_; }
  bool missed() const { return missed_; }
  bool turned_back() const { return turned_back_; }
  bool stuck() const { return stuck_; }
  /// A plane was crossed, so that there is a lateral error.
  bool reached() const { return reached_; }
  double lateral_error_m() const { return lateral_error_m_; }
  /// Distance before the next gate's plane; behind the last gate negative; 0 in a scene without gates.
  double distance_m(const Eigen::Vector3d& p_W_m) const;

  /// Throws mebots::Error for a state of a scene with another number of gates.
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
  /// How far the drone reaches from its centre along the gate's x axis.
  double reach_m(const GateFrame& gate, const RigidState& state) const;
  /// No gate is left to be crossed now.
  bool crossed_all() const { return !gates_.empty() && next_ == gates_.size(); }
  bool crosses_back(const RigidState& from, const RigidState& to) const;
  std::optional<GateEvent> cross(const RigidState& from, const RigidState& to);
  std::optional<GateEvent> get_stuck(std::size_t gate);

  std::vector<GateFrame> gates_;
  Eigen::Vector3d body_size_m_;

  std::uint64_t next_ = 0;  ///< the gate to be crossed
  bool crossed_ = false;    ///< all of them, at some time
  bool behind_ = false;
  bool touched_ = false;
  bool missed_ = false;
  bool turned_back_ = false;
  bool stuck_ = false;
  bool reached_ = false;
  double lateral_error_m_ = 0.0;
  std::vector<Contact> contacts_;  ///< the last one with each gate
};

}  // namespace mebots::world
