// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/bytes.hpp"
#include "scene/scene.hpp"

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

namespace mebots::world {

/// How the plane of a gate was crossed.
struct Crossing {
  std::size_t gate = 0;
  bool passed = false;      ///< through the opening
  double lateral_m = 0.0;   ///< left of the opening's middle, as flown
  double vertical_m = 0.0;  ///< above it
  Eigen::Vector3d p_W_m = Eigen::Vector3d::Zero();
};

/// Watches the drone's centre go through the gates, in the scene's order. The plane that counts is the
/// middle of the gate's thickness; the opening's border belongs to the opening. Only the next gate's
/// plane is watched, and only from its front: flying back through it changes nothing.
class GateJudge {
 public:
  explicit GateJudge(const std::vector<scene::Gate>& gates) : gates_(gates) {}

  /// The drone's centre went straight from one point to the other.
  std::optional<Crossing> move(const Eigen::Vector3d& from_W_m, const Eigen::Vector3d& to_W_m);

  bool all_passed() const { return !gates_.empty() && next_ == gates_.size(); }
  bool missed() const { return missed_; }
  double lateral_error_m() const { return lateral_error_m_; }
  /// Distance before the next gate's plane; behind the last gate negative; 0 in a scene without gates.
  double distance_m(const Eigen::Vector3d& p_W_m) const;

  void save(state::Writer& writer) const;
  void restore(state::Reader& reader);

 private:
  std::vector<scene::Gate> gates_;
  std::uint64_t next_ = 0;
  bool missed_ = false;
  double lateral_error_m_ = 0.0;
};

}  // namespace mebots::world
