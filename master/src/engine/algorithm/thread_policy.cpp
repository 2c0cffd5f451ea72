// SPDX-License-Identifier: Apache-2.0
#include "engine/algorithm/thread_policy.hpp"

#include <algorithm>

namespace mebots::master {

void ThreadPolicy::stepped() {
  ++steps_;
  if (!parallel_ && steps_ < kWindow) return;  // reads the clock only once per serial window
  const auto now = std::chrono::steady_clock::now();
  const double time_s = std::chrono::duration<double>(now - window_start_).count();
  if (steps_ < kWindow && time_s < to_beat_s()) return;
  window_took(time_s);
  steps_ = 0;
  window_start_ = now;
}

void ThreadPolicy::window_took(double time_s) {
  if (!parallel_) {
    serial_s_ = std::min(serial_s_, time_s);
    if (--left_ > 0) return;
    left_ = 1;  // checks again after the next window, because the steps may become longer
    if (to_beat_s() < kWindow * kLeastStep_s) return;
    parallel_ = true;
    left_ = kParallelRun;
    return;
  }
  if (time_s > kGain * to_beat_s()) {
    const bool first = left_ == kParallelRun;
    pause_ = first ? std::min(2 * pause_, kLongestPause) : kFirstPause;
    go_serial(pause_);
  } else if (--left_ == 0) {
    go_serial(kFirstWindows);  // measures the serial time again, because it may have changed
  }
}

void ThreadPolicy::go_serial(std::int64_t windows) {
  parallel_ = false;
  left_ = windows;
  earlier_s_[turn_] = serial_s_;
  turn_ = (turn_ + 1) % kRemembered;
  serial_s_ = std::numeric_limits<double>::infinity();
}

double ThreadPolicy::to_beat_s() const {
  return std::min(serial_s_, *std::min_element(earlier_s_.begin(), earlier_s_.end()));
}

}  // namespace mebots::master
