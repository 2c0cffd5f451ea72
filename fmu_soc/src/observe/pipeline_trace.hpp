// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/observer.hpp"
#include "observe/text_file.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace mebots::soc::observe {

/// Writes the instructions of one hart as a pipeline of four stages (F fetch, D decode, X execute, W write back), in
/// the format Kanata 0004, which Konata shows. Time is the hart's active cycles; a sleep takes none.
///
/// The stages are derived from the cycles by cause, not from a model of the pipeline. F has waits for cache lines,
/// entries of traps, and cycles of the previous jump. D has stalls, and X has all other cycles. The next instruction is
/// decoded while one executes, unless it was not fetched in time.
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
    std::string label;  // only for fetch
  };

  void write_before(std::int64_t cycle);
  void write(const Event& event);

  TextFile file_;
  std::vector<Event> waiting_;  // later than the last fetch
  std::uint64_t next_id_ = 0;
  bool began_ = false;
  std::int64_t written_cycle_ = 0;
  // The cycles in which the stages of the last instruction began, and the earliest possible cycles for the stages of
  // the next instruction.
  std::int64_t fetch_ = 0;
  std::int64_t decode_ = 0;
  std::int64_t execute_ = 0;
  std::int64_t end_ = 0;  // with the cycles that its jump or branch costs
  bool redirected_ = false;
};

}  // namespace mebots::soc::observe
