// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <mutex>
#include <string>

namespace mebots::live {

/// What threads ask of the one thread that steps a run. Only that thread touches the run: it takes the questions
/// between two steps, and answers them there.
class Mailbox {
 public:
  using Question = std::function<std::string()>;

  /// From any thread: what `question` returned, or throws, in the run's thread. Throws std::exception when nobody
  /// answers within `patience`, and from close() on.
  std::string ask(Question question, std::chrono::milliseconds patience);

  /// From the run's thread: answers what is there. Costs one atomic read when there is nothing.
  void answer_all();
  /// The same, after waiting for a question for at most `patience`.
  void wait_and_answer(std::chrono::milliseconds patience);
  /// Nobody answers any more: whoever waits is told so.
  void close();

 private:
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<std::packaged_task<std::string()>> waiting_;
  std::atomic<bool> any_{false};
  bool closed_ = false;
};

}  // namespace mebots::live
