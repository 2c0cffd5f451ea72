// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <thread>
#include <vector>

namespace mebots::master {

/// Decides by trial whether slaves step in parallel. Compares wall times of windows, which are sequences of kWindow
/// steps. The decision affects only speed, not results.
///
/// The first windows are serial. If the steps are long enough, tries a parallel window. Continues in parallel as long
/// as every window is faster than the fastest of the last few serial windows. Abandons a parallel window as soon as it
/// takes longer than a serial one, so a trial costs at most the time of one serial window. Repeated failures make
/// further trials rare.
class ThreadPolicy {
 public:
  static constexpr int kWindow = 16;
  /// Minimum duration of a step [s]. With shorter steps, no parallel window is tried, because waking threads and
  /// waiting for them takes at least this time.
  static constexpr double kLeastStep_s = 20e-6;
  /// Steps stay parallel only if a window of kWindow steps takes at most this fraction of the time of the fastest known
  /// serial window. Smaller differences are noise.
  static constexpr double kGain = 0.95;

  bool parallel() const { return parallel_; }
  /// Must be called after each communication step. Decides whether the next steps are parallel.
  void stepped();
  /// Records the wall time of a window of kWindow steps [s]. A parallel window may also end before its last step, if it
  /// already takes longer than a serial window.
  void window_took(double time_s);

 private:
  // Number of serial windows (of kWindow steps) before the first parallel window, and after kParallelRun parallel
  // windows.
  static constexpr std::int64_t kFirstWindows = 2;
  // After this number of consecutive parallel windows, steps become serial to measure the serial time again.
  static constexpr std::int64_t kParallelRun = 64;
  // Number of earlier phases of serial stepping whose shortest window times are stored for the comparison.
  static constexpr std::size_t kRemembered = 8;
  static constexpr std::int64_t kFirstPause = 16;
  static constexpr std::int64_t kLongestPause = 4096;

  static constexpr std::array<double, kRemembered> all_unknown() {
    std::array<double, kRemembered> all{};
    all.fill(std::numeric_limits<double>::infinity());
    return all;
  }

  void go_serial(std::int64_t windows);
  double to_beat_s() const;

  bool parallel_ = false;
  std::int64_t left_ = kFirstWindows;  // number of windows until the other mode is tried
  std::int64_t pause_ = kFirstPause;   // number of serial windows after a failed trial
  // Shortest wall time of a serial window since steps last became serial [s].
  double serial_s_ = std::numeric_limits<double>::infinity();
  std::array<double, kRemembered> earlier_s_ = all_unknown();  // times of earlier serial runs, as a ring buffer
  std::size_t turn_ = 0;
  int steps_ = 0;
  std::chrono::steady_clock::time_point window_start_ = std::chrono::steady_clock::now();
};

/// A pool of threads that steps slaves in parallel.
class StepPool {
 public:
  /// `threads` includes the thread of the caller.
  explicit StepPool(unsigned threads);
  ~StepPool();
  StepPool(const StepPool&) = delete;
  StepPool& operator=(const StepPool&) = delete;

  /// Calls work(0) ... work(count - 1) once each, in any order and on any thread. Returns when all calls have returned.
  /// `work` must not throw.
  void run(std::size_t count, const std::function<void(std::size_t)>& work);

 private:
  void serve();
  void take_work();

  std::vector<std::thread> threads_;
  const std::function<void(std::size_t)>* work_ = nullptr;
  std::size_t count_ = 0;
  std::atomic<std::size_t> next_{0};
  std::atomic<std::uint32_t> round_{0};  // incremented when work is available, and in the destructor
  std::atomic<std::uint32_t> busy_{0};   // number of threads that have not finished this round
  std::atomic<bool> over_{false};
};

}  // namespace mebots::master
