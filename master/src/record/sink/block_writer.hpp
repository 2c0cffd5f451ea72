// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "record/sink/row_block.hpp"

#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace mebots::master {

/// Hands blocks of rows to sinks on a thread of its own, one block at a time and in order, so that turning
/// numbers into text costs the simulation no time. The thread starts with the first full block: a short run has none.
class BlockWriter {
 public:
  BlockWriter() = default;
  ~BlockWriter();
  BlockWriter(const BlockWriter&) = delete;
  BlockWriter& operator=(const BlockWriter&) = delete;

  /// `sink` must outlive the writer.
  void add(RowSink& sink) { sinks_.push_back(&sink); }

  /// Takes the rows of `block` and leaves it empty; waits for the block before. Throws what a sink threw.
  void submit(RowBlock& block);
  /// Writes the rows of `block` on the calling thread, after all that were submitted; all is in the files then.
  void drain(RowBlock& block);

 private:
  void work();
  void wait_until_idle(std::unique_lock<std::mutex>& lock);
  void write(const RowBlock& block);

  std::vector<RowSink*> sinks_;
  std::mutex mutex_;
  std::condition_variable changed_;
  RowBlock pending_;
  bool busy_ = false;
  bool stopping_ = false;
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace mebots::master
