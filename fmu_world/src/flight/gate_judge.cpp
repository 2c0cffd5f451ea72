// SPDX-License-Identifier: Apache-2.0
#include "flight/gate_judge.hpp"

#include "mebots/error.hpp"

#include <algorithm>
#include <cmath>

namespace mebots::world {
namespace {

/// A point of the world in the gate's frame.
Eigen::Vector3d in_gate(const scene::Gate& gate, const Eigen::Vector3d& p_W_m) {
  const double c = std::cos(gate.yaw_rad);
  const double s = std::sin(gate.yaw_rad);
  const Eigen::Vector3d d = p_W_m - gate.p_W_m;
  return {c * d.x() + s * d.y(), -s * d.x() + c * d.y(), d.z()};
}

}  // namespace

std::optional<Crossing> GateJudge::move(const Eigen::Vector3d& from_W_m, const Eigen::Vector3d& to_W_m) {
  if (next_ >= gates_.size()) return std::nullopt;
  const scene::Gate& gate = gates_[next_];
  const Eigen::Vector3d a = in_gate(gate, from_W_m);
  const Eigen::Vector3d b = in_gate(gate, to_W_m);
  if (!(a.x() < 0.0 && b.x() >= 0.0)) return std::nullopt;

  const double share = a.x() / (a.x() - b.x());
  const Eigen::Vector3d at = a + share * (b - a);
  const double half_m = 0.5 * gate.inner_m;
  Crossing crossing;
  crossing.gate = next_;
  crossing.passed = std::abs(at.y()) <= half_m && std::abs(at.z()) <= half_m;
  crossing.lateral_m = at.y();
  crossing.vertical_m = at.z();
  crossing.p_W_m = from_W_m + share * (to_W_m - from_W_m);
  lateral_error_m_ = crossing.lateral_m;
  if (crossing.passed) {
    ++next_;
  } else {
    missed_ = true;
  }
  return crossing;
}

double GateJudge::distance_m(const Eigen::Vector3d& p_W_m) const {
  if (gates_.empty()) return 0.0;
  return -in_gate(gates_[std::min<std::size_t>(next_, gates_.size() - 1)], p_W_m).x();
}

void GateJudge::save(state::Writer& writer) const {
  writer.put(next_);
  writer.put(missed_);
  writer.put(lateral_error_m_);
}

void GateJudge::restore(state::Reader& reader) {
  reader.get(next_);
  if (next_ > gates_.size()) throw Error("a saved state of fmu_world belongs to a scene with more gates");
  reader.get(missed_);
  reader.get(lateral_error_m_);
}

}  // namespace mebots::world
