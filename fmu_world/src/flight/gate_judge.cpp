// SPDX-License-Identifier: Apache-2.0
#include "flight/gate_judge.hpp"

#include "math/rotation.hpp"
#include "mebots/error.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace mebots::world {
namespace {

constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::min();
/// The longest pause between two touches of one contact.
constexpr std::int64_t kTouchPause_ns = 500'000'000;
/// The duration of a contact after which the drone is stuck.
constexpr std::int64_t kStuckAfter_ns = 10'000'000'000;

}  // namespace

GateFrame::GateFrame(const scene::Gate& gate)
    : p_WG_m(gate.p_W_m),
      R_WG(scene::attitude_of(gate).toRotationMatrix()),
      inner_m(gate.inner_m, gate.opening_height_m()),
      outer_m(gate.outer_m, gate.frame_height_m()),
      thickness_m(gate.thickness_m) {
  const int count = gate.has_beams() ? 0 : gate.side_count();
  for (int i = 0; i < count; ++i) {
    const double from_bottom_rad = 2.0 * std::numbers::pi * i / count;
    sides.emplace_back(std::sin(from_bottom_rad), -std::cos(from_bottom_rad));
  }
}

bool GateFrame::within(const Eigen::Vector3d& p_G_m, const Eigen::Vector2d& size_m) const {
  if (sides.empty()) return std::abs(p_G_m.y()) <= 0.5 * size_m.x() && std::abs(p_G_m.z()) <= 0.5 * size_m.y();
  return std::all_of(sides.begin(), sides.end(),
                     [&](const Eigen::Vector2d& normal) { return normal.dot(p_G_m.tail<2>()) <= 0.5 * size_m.x(); });
}

GateJudge::GateJudge(std::vector<GateFrame> gates, const Eigen::Vector3d& body_size_m)
    : gates_(std::move(gates)), body_size_m_(body_size_m), contacts_(gates_.size(), Contact{kNever, kNever}) {}

double GateJudge::reach_m(const GateFrame& gate, const RigidState& state) const {
  const Eigen::Vector3d n_B = state.q_WB.conjugate() * gate.R_WG.col(0);
  return 0.5 * n_B.cwiseAbs().dot(body_size_m_);
}

bool GateJudge::whole_drone_in_front(const GateFrame& gate, const RigidState& state) const {
  return gate.in_gate(state.p_WB_m).x() + reach_m(gate, state) <= -0.5 * gate.thickness_m;
}

bool GateJudge::whole_drone_behind(const GateFrame& gate, const RigidState& state) const {
  return gate.in_gate(state.p_WB_m).x() - reach_m(gate, state) >= 0.5 * gate.thickness_m;
}

bool GateJudge::crosses_back(const RigidState& from, const RigidState& to) const {
  if (next_ == 0) return false;
  const GateFrame& gate = gates_[next_ - 1];
  if (!whole_drone_in_front(gate, to) || whole_drone_in_front(gate, from)) return false;
  return next_ == gates_.size() || gate.within_outline(gate.in_gate(to.p_WB_m));
}

std::optional<GateEvent> GateJudge::move(const RigidState& from, const RigidState& to) {
  std::optional<GateEvent> event;
  if (crosses_back(from, to)) {
    --next_;
    turned_back_ = true;
    event = GateEvent{GateEvent::Kind::turned_back, next_};
  } else if (next_ < gates_.size()) {
    event = cross(from, to);
  }
  behind_ = crossed_all() && whole_drone_behind(gates_.back(), to);
  return event;
}

std::optional<GateEvent> GateJudge::cross(const RigidState& from, const RigidState& to) {
  const GateFrame& gate = gates_[next_];
  const Eigen::Vector3d a = gate.in_gate(from.p_WB_m);
  const Eigen::Vector3d b = gate.in_gate(to.p_WB_m);
  if (!(a.x() < 0.0 && b.x() >= 0.0)) return std::nullopt;

  const Eigen::Vector3d at = a + a.x() / (a.x() - b.x()) * (b - a);
  const bool through = gate.within_opening(at);
  const GateEvent event{through ? GateEvent::Kind::crossed : GateEvent::Kind::missed, next_, at.y(), at.z()};
  reached_ = true;
  lateral_error_m_ = at.y();
  if (through) {
    ++next_;
    crossed_ = crossed_ || crossed_all();
  } else {
    missed_ = true;
  }
  return event;
}

std::optional<GateEvent> GateJudge::touch(std::size_t gate, std::int64_t time_ns) {
  touched_ = true;
  Contact& contact = contacts_[gate];
  const bool first = contact.last_ns == kNever || time_ns - contact.last_ns > kTouchPause_ns;
  if (first) contact.since_ns = time_ns;
  contact.last_ns = time_ns;
  if (first) return GateEvent{GateEvent::Kind::touched, gate};
  if (time_ns - contact.since_ns >= kStuckAfter_ns) return get_stuck(gate);
  return std::nullopt;
}

std::optional<GateEvent> GateJudge::land(const RigidState& at, std::int64_t time_ns) {
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    if (contacts_[i].last_ns != kNever && time_ns - contacts_[i].last_ns <= kTouchPause_ns) return get_stuck(i);
  }
  const bool in_the_plane = crossed_all() && !whole_drone_behind(gates_.back(), at);
  return in_the_plane ? get_stuck(gates_.size() - 1) : std::nullopt;
}

std::optional<GateEvent> GateJudge::get_stuck(std::size_t gate) {
  if (stuck_) return std::nullopt;
  stuck_ = true;
  return GateEvent{GateEvent::Kind::stuck, gate};
}

double GateJudge::distance_m(const Eigen::Vector3d& p_W_m) const {
  if (gates_.empty()) return 0.0;
  return -gates_[std::min<std::size_t>(next_, gates_.size() - 1)].in_gate(p_W_m).x();
}

void GateJudge::visit(state::Visitor& v) {
  v("contacts", contacts_);
  v("next", next_);
  if (contacts_.size() != gates_.size() || next_ > gates_.size()) {
    throw Error(ErrorCode::state_damaged,
                fmt::format("a saved state of fmu_world has {} gates, {} of them crossed; this scene has {}",
                            contacts_.size(), next_, gates_.size()));
  }
  v("crossed", crossed_);
  v("behind", behind_);
  v("touched", touched_);
  v("missed", missed_);
  v("turned_back", turned_back_);
  v("stuck", stuck_);
  v("reached", reached_);
  v("lateral_error_m", lateral_error_m_);
}

}  // namespace mebots::world
