// SPDX-License-Identifier: Apache-2.0
#include "observe/pipeline_trace.hpp"

#include "isa/encoding.hpp"
#include "runs/hart.hpp"

#include <algorithm>
#include <string_view>

namespace mebots::soc::observe {
namespace {

/// Offset of all cycle numbers. It keeps the fetch of the first instruction from starting before cycle 0.
constexpr std::int64_t kStagesBeforeExecute = 2;
constexpr std::string_view kStageNames[] = {"F", "D", "X", "W"};

/// Lists the causes of an instruction's cycles, except its first one.
std::string causes_text(const CycleShares& shares) {
  std::string text;
  for (std::size_t i = 1; i < kCycleCauses; ++i) {
    if (shares.cycles[i] != 0)
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", kCycleCauseNames[i], shares.cycles[i]);
  }
  return text;
}

}  // namespace

PipelineTrace::PipelineTrace(const std::string& option, const std::string& path) : file_(option, path) {
  file_.put("Kanata\t0004\n");
}

void PipelineTrace::retired(const Hart& hart, const Retired& instruction) {
  const auto& shares = instruction.cycles;
  const auto op = instruction.decoded.op;
  std::int64_t all = 0;
  for (const auto share : shares.cycles) all += share;
  if (!began_) end_ = kStagesBeforeExecute + static_cast<std::int64_t>(hart.counters().cycles) - all;
  // If the previous branch or jump had an unaligned target, the cycle of its fetch is counted for this instruction.
  // This cycle belongs to stage F.
  const auto before = is_jump(op) ? shares[CycleCause::branch] : is_branch(op) ? shares[CycleCause::jump] : 0;
  const auto fetch = shares[CycleCause::cache] + (op == Op::mret ? 0 : shares[CycleCause::trap]) + before;
  const auto stall = shares[CycleCause::load_use] + shares[CycleCause::jump_register];
  const auto penalty = (is_jump(op) ? shares[CycleCause::jump] : 0) + (is_branch(op) ? shares[CycleCause::branch] : 0);
  const auto execute = end_ + fetch + stall;
  const bool in_time = began_ && !redirected_ && fetch == 0;
  const auto decode = in_time ? execute_ : execute - stall - 1;
  const auto fetched = in_time ? decode_ : std::max(decode - 1 - fetch, fetch_);  // fetch_ is 0 at first
  end_ += all;
  const auto id = next_id_++;
  write_before(fetched);
  auto label = fmt::format("{:08x}: {}", instruction.pc, disassemble(instruction.word, instruction.pc));
  if (const auto causes = causes_text(shares); !causes.empty()) label += "\t" + causes;
  const auto write_back = std::max(end_ - penalty, execute + 1);
  waiting_.push_back({fetched, id, Stage::fetch, std::move(label)});
  waiting_.push_back({std::max(decode, fetched), id, Stage::decode, {}});
  waiting_.push_back({execute, id, Stage::execute, {}});
  waiting_.push_back({write_back, id, Stage::write_back, {}});
  waiting_.push_back({write_back + 1, id, Stage::retire, {}});
  fetch_ = fetched;
  decode_ = std::max(decode, fetched);
  execute_ = execute;
  redirected_ = hart.pc() != instruction.pc + instruction.decoded.length;
  began_ = true;
}

/// Writes all events that happen before `cycle`. All later events must be at or after this cycle.
void PipelineTrace::write_before(std::int64_t cycle) {
  std::ranges::stable_sort(waiting_, {}, &Event::cycle);
  const auto end = std::ranges::find_if(waiting_, [cycle](const Event& event) { return event.cycle >= cycle; });
  std::for_each(waiting_.begin(), end, [this](const Event& event) { write(event); });
  waiting_.erase(waiting_.begin(), end);
}

void PipelineTrace::write(const Event& event) {
  if (event.id == 0 && event.stage == Stage::fetch) {
    file_.print("C=\t{}\n", event.cycle);
  } else if (event.cycle != written_cycle_) {
    file_.print("C\t{}\n", event.cycle - written_cycle_);
  }
  written_cycle_ = event.cycle;
  const auto stage = static_cast<std::size_t>(event.stage);
  if (event.stage == Stage::fetch) {
    const auto tab = event.label.find('\t');
    file_.print("I\t{0}\t{0}\t0\nL\t{0}\t0\t{1}\n", event.id, event.label.substr(0, tab));
    if (tab != std::string::npos) file_.print("L\t{}\t1\t{}\n", event.id, event.label.substr(tab + 1));
  } else {
    file_.print("E\t{}\t0\t{}\n", event.id, kStageNames[stage - 1]);
  }
  if (event.stage == Stage::retire) {
    file_.print("R\t{0}\t{0}\t0\n", event.id);
  } else {
    file_.print("S\t{}\t0\t{}\n", event.id, kStageNames[stage]);
  }
}

void PipelineTrace::close() {
  write_before(end_ + 2);
  file_.close();
}

}  // namespace mebots::soc::observe
