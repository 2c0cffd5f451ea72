// SPDX-License-Identifier: Apache-2.0
#include "system/initial_values.hpp"

#include <fmt/format.h>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>

namespace mebots::master {
namespace {

/// Sweeps beyond the longest chain of connections that a loop gets to settle by itself.
constexpr int kLoopSweeps = 200;
constexpr int kNewtonSteps = 50;
constexpr int kHalvings = 12;
/// Relative change below which a value stands still; a value near zero is compared with kSmall.
constexpr double kStill = 1e-12;
constexpr double kSmall = 1e-9;
/// A loop that gets there by sweeping is left to Newton's method before numbers overflow.
constexpr double kApart = 1e30;

bool close(double a, double b) {
  return a == b || std::abs(a - b) <= kStill * std::max({std::abs(a), std::abs(b), kSmall});
}

double norm(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum);
}

}  // namespace

InitialValues::InitialValues(Ensemble& ensemble) : ensemble_(ensemble) {
  for (const auto& input : torn_inputs(*ensemble.system_)) {
    if (kind_of(input.variable->type) != ValueKind::real) {
      only_reals_ = false;
      continue;
    }
    cuts_.push_back({input.instance, ensemble.members_[input.instance].inputs.reals.slots.at(input.variable)});
  }
}

void InitialValues::settle() {
  if (ensemble_.system_->connections.empty()) return;
  const auto chain = static_cast<int>(ensemble_.size()) + 2;
  const bool solvable = only_reals_ && !cuts_.empty();
  std::exception_ptr not_finite;
  try {
    if (sweep(chain + kLoopSweeps, false)) return;
  } catch (const NotFiniteError&) {
    if (!solvable || held_.empty()) throw;  // not for want of a solution
    not_finite = std::current_exception();
  }
  if (solvable && newton()) return;
  if (not_finite) std::rethrow_exception(not_finite);
  fail(fmt::format("after {} sweeps along the connections{}", chain + kLoopSweeps,
                   solvable ? " and by Newton's method" : ""));
}

void InitialValues::fail(const std::string& what) const {
  const auto loop = initial_loop(*ensemble_.system_);
  throw Error(ErrorCode::algebraic_loop,
              fmt::format("the initial values do not settle {}{}. Cut the loop, or give the FMUs other start values",
                          what, loop.empty() ? "" : fmt::format("; they run in a loop: {}", loop)));
}

bool InitialValues::sweep(int sweeps, bool hold_cuts) {
  // All outputs are read before any input is set, so that the order of the instances is nothing.
  std::vector<Banks> before;
  for (int i = 0; i < sweeps; ++i) {
    before = ensemble_.outputs();
    for (std::size_t k = 0; k < ensemble_.size(); ++k) ensemble_.read_outputs(k, 0);
    if (i == 0 && held_.empty() && !cuts_.empty()) {
      // Where Newton starts, should it be needed: what the cut inputs get from start values alone.
      for (std::size_t k = 0; k < ensemble_.size(); ++k) ensemble_.collect_inputs(k);
      held_ = cut_values();
    }
    if (i > 0 && standing_still(before)) return true;
    if (!hold_cuts && driven_apart()) return false;
    for (std::size_t k = 0; k < ensemble_.size(); ++k) write(k, hold_cuts);
  }
  return false;
}

void InitialValues::write(std::size_t instance, bool hold_cuts) {
  ensemble_.collect_inputs(instance);
  if (hold_cuts) {
    for (std::size_t i = 0; i < cuts_.size(); ++i) {
      if (cuts_[i].instance == instance) {
        ensemble_.members_[instance].inputs.reals.values[cuts_[i].slot] = held_[i];
      }
    }
  }
  ensemble_.hand_inputs(instance);
}

bool InitialValues::standing_still(const std::vector<Banks>& before) const {
  // Only what travels counts: a watched variable that nobody takes may be a clock of the FMU's own.
  return std::ranges::all_of(ensemble_.system_->connections, [&](const ResolvedConnection& connection) {
    if (connection.pointer) return true;  // an FMU may hand out another buffer at each call
    const auto& old = before[connection.from.instance];
    const auto& now = ensemble_.members_[connection.from.instance].outputs;
    const auto same = [&](const auto& old_bank, const auto& bank, auto equal) {
      const auto slot = bank.slots.at(connection.from.variable);
      return equal(old_bank.values[slot], bank.values[slot]);
    };
    switch (kind_of(connection.from.variable->type)) {
      case ValueKind::real:
        return same(old.reals, now.reals, close);
      case ValueKind::integer:
        return same(old.integers, now.integers, std::equal_to<>());
      case ValueKind::boolean:
        return same(old.booleans, now.booleans, std::equal_to<>());
      case ValueKind::string:
        break;
    }
    return same(old.strings, now.strings, std::equal_to<>());
  });
}

/// Far from any solution, but still finite: the slaves can come back from there.
bool InitialValues::driven_apart() const {
  return std::ranges::any_of(cut_values(), [](double value) { return std::abs(value) > kApart; });
}

std::vector<double> InitialValues::cut_values() const {
  std::vector<double> values;
  for (const auto& cut : cuts_) values.push_back(ensemble_.members_[cut.instance].inputs.reals.values[cut.slot]);
  return values;
}

/// G(x) - x, with x at the cuts; nothing when some value is NaN or infinite, or what hangs on x does not settle.
std::optional<std::vector<double>> InitialValues::residual(const std::vector<double>& x) {
  held_ = x;
  try {
    // Every sweep that changes something carries it one connection further.
    if (!sweep(static_cast<int>(ensemble_.system_->connections.size()) + 2, true)) return std::nullopt;
    for (std::size_t k = 0; k < ensemble_.size(); ++k) ensemble_.collect_inputs(k);
  } catch (const NotFiniteError&) {
    return std::nullopt;
  }
  auto result = cut_values();
  for (std::size_t i = 0; i < x.size(); ++i) result[i] -= x[i];
  return result;
}

bool InitialValues::newton() {
  const auto n = static_cast<Eigen::Index>(cuts_.size());
  auto x = held_;
  auto r = residual(x);
  if (!r) return false;
  const auto solved = [&] {
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (!close((*r)[i] + x[i], x[i])) return false;
    }
    return true;
  };
  for (int step = 0; step < kNewtonSteps; ++step) {
    if (solved()) {
      residual(x);  // the slaves may stand at a neighbour of x
      for (std::size_t k = 0; k < ensemble_.size(); ++k) write(k, false);
      return true;
    }
    Eigen::MatrixXd jacobian(n, n);
    for (Eigen::Index j = 0; j < n; ++j) {
      auto moved = x;
      auto& coordinate = moved[static_cast<std::size_t>(j)];
      coordinate += std::sqrt(std::numeric_limits<double>::epsilon()) * std::max(1.0, std::abs(coordinate));
      const double distance = coordinate - x[static_cast<std::size_t>(j)];
      const auto there = residual(moved);
      if (!there) return false;
      for (Eigen::Index i = 0; i < n; ++i) {
        const auto row = static_cast<std::size_t>(i);
        jacobian(i, j) = ((*there)[row] - (*r)[row]) / distance;
      }
    }
    const Eigen::FullPivLU<Eigen::MatrixXd> lu(jacobian);
    if (!lu.isInvertible()) return false;
    const Eigen::VectorXd direction = lu.solve(-Eigen::Map<const Eigen::VectorXd>(r->data(), n));
    // Shorter steps where a whole one makes it worse.
    double length = 1;
    bool better = false;
    for (int halving = 0; halving < kHalvings && !better; ++halving, length /= 2) {
      auto tried = x;
      for (std::size_t i = 0; i < x.size(); ++i) tried[i] += length * direction(static_cast<Eigen::Index>(i));
      const auto there = residual(tried);
      if (!there || norm(*there) >= norm(*r)) continue;
      x = std::move(tried);
      r = there;
      better = true;
    }
    if (!better) return false;
  }
  return false;
}

}  // namespace mebots::master
