// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "record/sink/row_block.hpp"

#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace mebots::master {

/// Passes blocks of rows to sinks on another thread, so that the simulation does not wait for files. Blocks stay in
/// order. The thread starts at the first full block.
class BlockWriter {
 public:
  BlockWriter() = default;
  ~BlockWriter();
  BlockWriter(const BlockWriter&) = delete;
  BlockWriter& operator=(const BlockWriter&) = delete;

  /// Adds a sink, which must outlive the writer.
  void add(RowSink& sink) { sinks_.push_back(&sink); }

  /// Waits until the previous block is written, then takes the rows out of `block`. Rethrows exceptions of sinks.
  void submit(RowBlock& block);
  /// Waits until all blocks are written, then writes `block` on the calling thread and flushes the sinks. Rethrows
  /// exceptions of sinks.
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
