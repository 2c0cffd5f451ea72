// SPDX-License-Identifier: Apache-2.0
#include "engine/initial_values.hpp"

#include <fmt/format.h>
#include <Eigen/LU>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <exception>
#include <limits>
#include <numeric>

namespace mebots::master {
namespace {

/// Number of sweeps beyond the longest chain of connections before Newton's method solves the loop.
constexpr int kLoopSweeps = 200;
constexpr int kNewtonSteps = 50;
constexpr int kHalvings = 12;
/// A value has converged if its relative change is at most kStill. Near zero, the change is relative to kSmall.
constexpr double kStill = 1e-12;
constexpr double kSmall = 1e-9;
/// Sweeps stop if a value in a loop exceeds this magnitude, before numbers overflow.
constexpr double kApart = 1e30;

bool close(double a, double b) {
  return a == b || std::abs(a - b) <= kStill * std::max({std::abs(a), std::abs(b), kSmall});
}

struct OutputValues {
  explicit OutputValues(const Banks& banks)
      : reals(banks.reals.values),
        integers(banks.integers.values),
        booleans(banks.booleans.values),
        strings(banks.strings.values),
        binaries(banks.binaries.values) {}

  std::vector<double> reals;
  std::vector<std::int64_t> integers;
  std::vector<std::int64_t> booleans;
  std::vector<std::string> strings;
  std::vector<std::string> binaries;
};

bool is_same(const OutputValues& before, const Banks& now, ValueKind kind, std::size_t slot) {
  switch (kind) {
    case ValueKind::real:
      return std::bit_cast<std::uint64_t>(before.reals[slot]) == std::bit_cast<std::uint64_t>(now.reals.values[slot]);
    case ValueKind::integer:
      return before.integers[slot] == now.integers.values[slot];
    case ValueKind::boolean:
      return before.booleans[slot] == now.booleans.values[slot];
    case ValueKind::binary:
      return before.binaries[slot] == now.binaries.values[slot];
    case ValueKind::clock:  // banks contain no clocks
    case ValueKind::string:
      break;
  }
  return before.strings[slot] == now.strings.values[slot];
}

double norm(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum);
}

}  // namespace

InitialValues::InitialValues(Ensemble& ensemble) : ensemble_(ensemble), links_(ensemble.size()) {
  for (const auto& connection : ensemble.system_->connections) {
    const auto from = ensemble.watch(connection.from);
    links_[from.instance].push_back({from.kind, from.slot, connection.to.instance, connection.pointer});
  }
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
    if (!solvable || held_.empty()) throw;  // the loop did not cause the error
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
              fmt::format("the initial values do not converge {}{}. Cut the loop, or give the FMUs other start values",
                          what, loop.empty() ? "" : fmt::format("; their connections form a loop: {}", loop)));
}

bool InitialValues::sweep(int sweeps, bool hold_cuts) {
  // Reads all outputs before it sets any input, so that the order of the instances has no effect.
  std::vector<std::size_t> all(ensemble_.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  auto changed = all;
  for (int i = 0; i < sweeps; ++i) {
    Change change;
    for (const auto k : changed) read(k, change);
    if (i == 0 && held_.empty() && !cuts_.empty()) {
      // Newton's method varies the inputs that cut all loops. Their start values result from the first read of all
      // outputs.
      for (const auto k : all) ensemble_.collect_inputs(k);
      held_ = cut_values();
    }
    if (i > 0 && change.is_settled) return true;
    if (!hold_cuts && driven_apart()) return false;
    std::ranges::sort(change.driven);
    // std::ranges::unique() does not compile with libstdc++ and clang 14, which builds the fuzzers.
    change.driven.erase(std::unique(change.driven.begin(), change.driven.end()), change.driven.end());
    changed = i == 0 ? all : std::move(change.driven);
    for (const auto k : changed) write(k, hold_cuts);
  }
  return false;
}

/// Reads the outputs of the instance and detects changes of connected outputs. Other outputs, such as a clock time, may
/// change at each call.
void InitialValues::read(std::size_t instance, Change& change) {
  const auto& outputs = ensemble_.members_[instance].outputs;
  const OutputValues before(outputs);
  ensemble_.read_outputs(instance, 0);
  for (const auto& link : links_[instance]) {
    if (!link.is_pointer && is_same(before, outputs, link.kind, link.slot)) continue;
    change.driven.push_back(link.to);
    if (link.is_pointer) continue;
    const bool is_close =
        link.kind == ValueKind::real && close(before.reals[link.slot], outputs.reals.values[link.slot]);
    if (!is_close) change.is_settled = false;
  }
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
  Ensemble::keep_in_ranges(ensemble_.members_[instance]);
  ensemble_.hand_inputs(instance);
}

/// True if an input that cuts a loop has a value with a magnitude above kApart.
bool InitialValues::driven_apart() const {
  return std::ranges::any_of(cut_values(), [](double value) { return std::abs(value) > kApart; });
}

std::vector<double> InitialValues::cut_values() const {
  std::vector<double> values;
  for (const auto& cut : cuts_) values.push_back(ensemble_.members_[cut.instance].inputs.reals.values[cut.slot]);
  return values;
}

/// Returns G(x) - x, where x are the values of the inputs that cut all loops. Returns nullopt if a value is NaN or
/// infinite, or if the other values do not converge.
std::optional<std::vector<double>> InitialValues::residual(const std::vector<double>& x) {
  held_ = x;
  try {
    // A changed value passes at least one more connection in each sweep, so the number of connections limits the number
    // of sweeps.
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
      residual(x);  // sets the slaves to x; they may still contain values of a neighbouring point
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
    // Halves the step of Newton's method as long as the step increases the residual.
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
