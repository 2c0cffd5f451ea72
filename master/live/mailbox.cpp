// SPDX-License-Identifier: Apache-2.0
#include "mailbox.hpp"

#include <stdexcept>
#include <utility>

namespace mebots::live {

std::string Mailbox::ask(Question question, std::chrono::milliseconds patience) {
  std::packaged_task<std::string()> task(std::move(question));
  auto answer = task.get_future();
  {
    const std::lock_guard lock(mutex_);
    if (closed_) throw std::runtime_error("the run is over");
    waiting_.push_back(std::move(task));
    any_.store(true, std::memory_order_release);
  }
  arrived_.notify_one();
  if (answer.wait_for(patience) != std::future_status::ready) throw std::runtime_error("the run does not answer");
  return answer.get();
}

void Mailbox::answer_all() {
  if (!any_.load(std::memory_order_acquire)) return;
  std::deque<std::packaged_task<std::string()>> tasks;
  {
    const std::lock_guard lock(mutex_);
    tasks.swap(waiting_);
    any_.store(false, std::memory_order_release);
  }
  for (auto& task : tasks) task();
}

void Mailbox::wait_and_answer(std::chrono::milliseconds patience) {
  {
    std::unique_lock lock(mutex_);
    arrived_.wait_for(lock, patience, [this] { return !waiting_.empty(); });
  }
  answer_all();
}

void Mailbox::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  waiting_.clear();  // their promises are broken, which their futures throw
}

}  // namespace mebots::live
