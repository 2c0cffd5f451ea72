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

/// Finds out by trying whether stepping in parallel is faster, from the wall time of windows of steps. Its choice
/// affects speed only: the results are the same bits either way.
///
/// Serial windows come first: the fastest of the last few serial runs is what parallel has to beat, so that cheap steps
/// are never compared with dear ones that went before. When their steps are long enough for
/// threads to have a chance, parallel is tried, and kept as long as every window wins. It is given up in the middle of
/// a window that takes longer than a serial one, so that a trial costs one serial window at most. Trials that fail
/// become rare.
class ThreadPolicy {
 public:
  /// Steps in one window.
  static constexpr int kWindow = 16;
  /// Waking threads and waiting for them costs this much [s] at least: shorter steps are never tried in parallel.
  static constexpr double kLeastStep_s = 20e-6;
  /// Parallel must save at least a twentieth: what is within the noise stays serial.
  static constexpr double kGain = 0.95;

  /// How the next step is to be taken.
  bool parallel() const { return parallel_; }
  /// One more step was taken.
  void stepped();
  /// A window took so long [s], or was given up after so long.
  void window_took(double time_s);

 private:
  static constexpr std::int64_t kFirstWindows = 2;  // serial ones, before the first trial and between parallel runs
  static constexpr std::int64_t kParallelRun = 64;
  static constexpr std::size_t kRemembered = 8;  // serial runs; what was faster before them no longer counts
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
  std::int64_t left_ = kFirstWindows;  // windows until the other way gets its turn
  std::int64_t pause_ = kFirstPause;   // serial windows after a trial that failed
  double serial_s_ =
      std::numeric_limits<double>::infinity();  // the fastest serial window of this or the last serial run
  std::array<double, kRemembered> earlier_s_ = all_unknown();  // the same of the runs before, in turn
  std::size_t turn_ = 0;
  int steps_ = 0;
  std::chrono::steady_clock::time_point window_start_ = std::chrono::steady_clock::now();
};

/// Threads that share the work of one communication step.
class StepPool {
 public:
  /// `threads` in all, the caller's own among them.
  explicit StepPool(unsigned threads);
  ~StepPool();
  StepPool(const StepPool&) = delete;
  StepPool& operator=(const StepPool&) = delete;

  /// Calls work(0) ... work(count - 1), each once, in any order and on any thread, and returns when all are done.
  /// `work` must not throw.
  void run(std::size_t count, const std::function<void(std::size_t)>& work);

 private:
  void serve();
  void take_work();

  std::vector<std::thread> threads_;
  const std::function<void(std::size_t)>* work_ = nullptr;
  std::size_t count_ = 0;
  std::atomic<std::size_t> next_{0};
  std::atomic<std::uint32_t> round_{0};  // changes when there is work, and at the end
  std::atomic<std::uint32_t> busy_{0};   // threads that have not finished this round
  std::atomic<bool> over_{false};
};

}  // namespace mebots::master
