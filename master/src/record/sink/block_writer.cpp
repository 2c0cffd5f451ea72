// SPDX-License-Identifier: Apache-2.0
#include "record/sink/block_writer.hpp"

#include "base/own_threads.hpp"
#include "mebots/assert.hpp"

#include <utility>

namespace mebots::master {

BlockWriter::~BlockWriter() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void BlockWriter::submit(RowBlock& block) {
  // Starts the thread before it has work. If the start fails, no later call waits for the thread.
  if (!thread_.joinable()) thread_ = std::thread([this] { work(); });
  {
    std::unique_lock lock(mutex_);
    wait_until_idle(lock);
    pending_.clear();
    MEBOTS_ASSERT(block.cells_per_row > 0 && block.cells.size() % block.cells_per_row == 0, "whole rows");
    pending_.cells_per_row = block.cells_per_row;
    std::swap(pending_, block);
    busy_ = true;
  }
  changed_.notify_all();
}

void BlockWriter::drain(RowBlock& block) {
  {
    std::unique_lock lock(mutex_);
    wait_until_idle(lock);
  }
  // The thread now waits for the next submit(). Empties the block even if a sink throws.
  const auto rows = std::exchange(block, RowBlock{block.cells_per_row, {}, {}});
  write(rows);
  for (auto* sink : sinks_) sink->flush();
}

void BlockWriter::wait_until_idle(std::unique_lock<std::mutex>& lock) {
  changed_.wait(lock, [&] { return !busy_; });
  if (failure_) std::rethrow_exception(failure_);  // rethrown at every later call, because rows are missing
}

void BlockWriter::work() {
  const OwnThread own;
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return busy_ || stopping_; });
    if (!busy_) return;
    lock.unlock();
    std::exception_ptr failure;
    try {
      write(pending_);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    if (!failure_) failure_ = failure;
    busy_ = false;
    changed_.notify_all();
  }
}

void BlockWriter::write(const RowBlock& block) {
  for (auto* sink : sinks_) sink->write(block);
}

}  // namespace mebots::master
