// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/observer.hpp"
#include "observe/text_file.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace mebots::soc::observe {

/// Writes the instructions of one hart as a pipeline of four stages (F fetch, D decode, X execute, W write back). The
/// file has the format Kanata 0004, which the viewer Konata displays. Time is counted in active cycles of the hart, so
/// that a sleep takes no time.
///
/// The stages are derived from the causes of the cycles, not from a model of the pipeline. F contains waits for cache
/// lines, entries of traps, and cycles of the previous jump. D contains stalls, and X contains all other cycles. While
/// an instruction is in X, the next instruction is in D, unless it was fetched too late.
class PipelineTrace final : public Observer {
 public:
  PipelineTrace(const std::string& option, const std::string& path);

  void retired(const Hart& hart, const Retired& instruction) override;
  void close();

 private:
  enum class Stage : std::uint8_t { fetch, decode, execute, write_back, retire };
  struct Event {
    std::int64_t cycle = 0;
    std::uint64_t id = 0;
    Stage stage = Stage::fetch;
    std::string label;  // only set for the stage `fetch`
  };

  void write_before(std::int64_t cycle);
  void write(const Event& event);

  TextFile file_;
  std::vector<Event> waiting_;  // events that are later than the last fetch
  std::uint64_t next_id_ = 0;
  bool began_ = false;
  std::int64_t written_cycle_ = 0;
  // Cycles in which the stages of the last instruction started, and the earliest cycles in which the stages of the next
  // instruction can start.
  std::int64_t fetch_ = 0;
  std::int64_t decode_ = 0;
  std::int64_t execute_ = 0;
  std::int64_t end_ = 0;  // end of the last instruction, including the cycles that its jump or branch costs
  bool redirected_ = false;
};

}  // namespace mebots::soc::observe
