// SPDX-License-Identifier: Apache-2.0
#include "soc/timeline.hpp"

#include "mebots/error.hpp"

namespace mebots::soc {

void Timeline::sleep(bool retained) {
  asleep_ = true;
  asleep_since_ = core_time();
  retained_ = retained;
}

void Timeline::end_retention(Picoseconds time) {
  retention_ += time - asleep_since_;
  retained_ = false;
}

void Timeline::wake(Picoseconds time) {
  clock_.wake(hart_.counters().cycles, time);
  slept_ += core_time() - asleep_since_;
  asleep_ = false;
}

/// If the fabric controller sleeps, it continues to sleep.
void Timeline::finish(End why, Picoseconds time) {
  end_ = why;
  end_time_ = std::max(core_time(), time);
  if (!asleep_) asleep_since_ = end_time_;
  asleep_ = true;
}

void Timeline::power_off() {
  slept_ = slept_at(now_);
  retention_ = retention_at(now_);
  retained_ = false;
  end_ = End::powered_off;
  end_time_ = now_;
  asleep_ = true;
  asleep_since_ = kNever;
}

Picoseconds Timeline::reached(const Cluster* cluster) const {
  if (!running()) return std::max(now_, end_time_);
  const auto of_cluster = cluster != nullptr ? cluster->reached() : 0;
  return std::max({now_, asleep_ ? asleep_since_ : core_time(), of_cluster});
}

void Timeline::visit(state::Visitor& v) {
  v("clock", clock_);
  v("now", now_);
  v("end", end_);
  v("end_time", end_time_);
  v("ended_by", ended_by_);
  v("asleep", asleep_);
  v("asleep_since", asleep_since_);
  v("slept", slept_);
  v("retained", retained_);
  v("retention", retention_);
}

void Timeline::check(const Cluster* cluster) const {
  const int cores = cluster != nullptr ? static_cast<int>(cluster->cores()) : 0;
  if (ended_by_ >= kFabricControllerCore && ended_by_ < cores) return;
  throw Error(ErrorCode::state_damaged, "a saved state is damaged: the core that ended the program does not exist");
}

}  // namespace mebots::soc
