// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <thread>
#include <vector>

namespace mebots::master {

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
