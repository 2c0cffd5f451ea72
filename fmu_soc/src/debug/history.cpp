// SPDX-License-Identifier: Apache-2.0
#include "debug/history.hpp"

#include "devices/core/chip_host.hpp"
#include "mebots/assert.hpp"
#include "mebots/state/save.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace mebots::soc::debug {

void History::record(const Soc& soc) {
  if (!snapshots_.empty() && (position_ < frontier_ || position_ <= snapshots_.back().position)) return;
  if (++pieces_ < gap_ && !snapshots_.empty()) return;
  pieces_ = 0;
  snapshots_.push_back({position_, calls_, inputs_, state::save(soc)});
  if (position_ == 0) start_ = snapshots_.back();
  while (snapshots_.size() > 2 && (snapshots_.size() > kMost || bytes() > most_bytes_)) thin();
}

std::size_t History::bytes() const {
  const auto add = [](std::size_t sum, const Snapshot& one) { return sum + one.state.size(); };
  return std::accumulate(snapshots_.begin(), snapshots_.end(), start_.state.size(), add);
}

/// Deletes every second saved state except the newest, and doubles the distance between later states.
void History::thin() {
  std::vector<Snapshot> kept;
  for (std::size_t i = 0; i < snapshots_.size(); ++i) {
    if (i % 2 == 0 || i + 1 == snapshots_.size()) kept.push_back(std::move(snapshots_[i]));
  }
  snapshots_ = std::move(kept);
  gap_ *= 2;
}

void History::restore(Soc& soc, std::size_t snapshot) {
  MEBOTS_ASSERT(snapshot < snapshots_.size());
  const auto& from = snapshots_[snapshot];
  state::restore(soc, from.state);
  position_ = from.position;
  calls_ = from.calls;
  inputs_ = from.inputs;
}

void History::restart(Soc& soc) {
  MEBOTS_ASSERT(has_start());
  snapshots_ = {start_};
  restore(soc, 0);
  frontier_ = 0;
  latest_call_ = 0;
  gap_ = 1;
}

void History::cut() {
  snapshots_.clear();
  frontier_ = position_;
  latest_call_ = calls_;
}

void History::clear() {
  cut();
  start_ = {};
}

int History::input(const std::function<int()>& read) {
  if (leaves_) return ConsolePort::kNothingYet;  // the state will be replaced by an earlier one
  ++calls_;
  const bool again = calls_ <= latest_call_;
  latest_call_ = std::max(latest_call_, calls_);
  if (inputs_ < log_.size()) return log_[inputs_].call <= calls_ ? log_[inputs_++].result : ConsolePort::kNothingYet;
  if (again) return ConsolePort::kNothingYet;
  const int result = read();
  if (result == ConsolePort::kNothingYet) return result;
  log_.push_back({calls_, result});
  ++inputs_;
  return result;
}

}  // namespace mebots::soc::debug
