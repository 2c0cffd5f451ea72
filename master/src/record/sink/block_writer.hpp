// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "record/sink/row_block.hpp"

#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace mebots::master {

/// Passes blocks of rows to sinks on a separate thread, one block at a time and in order, so that the simulation does
/// not wait for formatting. The thread starts with the first full block, so a short run does not start a thread.
class BlockWriter {
 public:
  BlockWriter() = default;
  ~BlockWriter();
  BlockWriter(const BlockWriter&) = delete;
  BlockWriter& operator=(const BlockWriter&) = delete;

  /// `sink` must outlive the writer.
  void add(RowSink& sink) { sinks_.push_back(&sink); }

  /// Moves the rows out of `block`, after the previous block has been written. Rethrows exceptions of sinks.
  void submit(RowBlock& block);
  /// Writes the rows of `block` on the calling thread after all submitted blocks. Afterwards all rows are in the files.
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
