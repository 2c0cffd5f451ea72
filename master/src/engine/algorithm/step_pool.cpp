// SPDX-License-Identifier: Apache-2.0
#include "engine/algorithm/thread_policy.hpp"

#include "base/own_threads.hpp"
#include "mebots/assert.hpp"

#include <pthread.h>

namespace mebots::master {

StepPool::StepPool(unsigned threads) {
  MEBOTS_ASSERT(threads > 0, "the caller works too");
  for (unsigned i = 1; i < threads; ++i) threads_.emplace_back([this] { serve(); });
}

StepPool::~StepPool() {
  over_ = true;
  ++round_;
  round_.notify_all();
  for (auto& thread : threads_) thread.join();
}

void StepPool::run(std::size_t count, const std::function<void(std::size_t)>& work) {
  MEBOTS_ASSERT(busy_.load() == 0, "one round after the other");
  MEBOTS_ASSERT(work != nullptr);
  work_ = &work;
  count_ = count;
  next_ = 0;
  busy_ = static_cast<std::uint32_t>(threads_.size());
  ++round_;
  round_.notify_all();
  take_work();
  // The next round may change shared data only after all threads have finished this round.
  for (auto busy = busy_.load(); busy != 0; busy = busy_.load()) busy_.wait(busy);
}

void StepPool::serve() {
  const OwnThread own;
  pthread_setcancelstate(PTHREAD_CANCEL_DISABLE, nullptr);  // an FMU must not cancel this thread
  std::uint32_t seen = 0;
  for (;;) {
    round_.wait(seen);
    seen = round_.load();
    if (over_) return;
    take_work();
    if (--busy_ == 0) busy_.notify_one();
  }
}

void StepPool::take_work() {
  for (auto i = next_.fetch_add(1); i < count_; i = next_.fetch_add(1)) (*work_)(i);
}

}  // namespace mebots::master
