// SPDX-License-Identifier: Apache-2.0
//
// Implements the backward steps of gdb. A request ends the run. rewind() restores an earlier state, and the same
// instructions are executed again:
//
// In the phase `searching`, the replay runs up to the present position and records the last position at which gdb wants
// to stop. If there is no such position, the search continues from the preceding saved state. In the phase `seeking`,
// the replay runs from the same state to that position, where gdb stops.
#include "debug/gdb_server.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace mebots::soc::debug {
namespace {

constexpr std::string_view kAtBegin = "replaylog:begin;";
constexpr std::string_view kHint = "'maintenance flush register-cache' makes gdb read the registers again\n";

}  // namespace

/// Returns the index of the last saved state before an instruction, given by its position in the history. Returns
/// nullopt if there is no such state.
std::optional<std::size_t> GdbServer::state_before(std::uint64_t position) const {
  const auto& states = history_->snapshots();
  const auto after = std::ranges::lower_bound(states, position, {}, &History::Snapshot::position);
  if (after == states.begin()) return std::nullopt;
  return static_cast<std::size_t>(after - states.begin()) - 1;
}

/// Starts a backward request: "bs" returns by one instruction of the chosen hart, "bc" returns to the last breakpoint
/// or watchpoint.
GdbServer::Resume GdbServer::reverse(bool by_step) {
  const auto from = state_before(here_);
  if (!from) {
    stop(threads_.chosen(), kTrap, kAtBegin);
    connection_.send(stop_reply_);
    return Resume::no;
  }
  replay_ = Replay{
      .phase = Replay::Phase::searching, .from = *from, .limit = here_, .by_step = by_step, .hart = threads_.chosen()};
  return Resume::rewind;
}

/// Executes the commands of `monitor` that name a position in the run, or return to one: save, restore and reset.
/// Returns nullopt for any other command.
std::optional<GdbServer::Resume> GdbServer::travel(std::string_view command) {
  constexpr std::string_view kSave = "save ";
  constexpr std::string_view kRestore = "restore ";
  const auto reply = [this](std::string_view text) {
    connection_.send(to_hex(text));
    return Resume::no;
  };
  if (command.starts_with(kSave)) {
    const auto name = std::string(command.substr(kSave.size()));
    names_[name] = here_;
    return reply(fmt::format("saved as {}\n", name));
  }
  if (command == "reset") {
    if (!history_->has_start()) {
      return reply(
          "gdb cannot go back to the start of the run, because the co-simulation has restored a state since then\n");
    }
    names_.clear();
    replay_ = Replay{.phase = Replay::Phase::restarting, .place = {.position = 1}};
    answer_ = to_hex(fmt::format("at the start of the run; {}", kHint));
    return Resume::rewind;
  }
  if (!command.starts_with(kRestore)) return std::nullopt;
  const auto name = std::string(command.substr(kRestore.size()));
  const auto found = names_.find(name);
  if (found == names_.end()) return reply(fmt::format("there is no saved state '{}'\n", name));
  const auto from = state_before(found->second);
  if (!from) {
    return reply(
        fmt::format("the history does not reach '{}': it begins again after a change by gdb, and after the "
                    "co-simulation has restored a state\n",
                    name));
  }
  replay_ = Replay{.phase = Replay::Phase::seeking, .from = *from, .place = {.position = found->second}};
  answer_ = to_hex(fmt::format("at {}; {}", name, kHint));
  return Resume::rewind;
}

bool GdbServer::rewind() {
  if (!history_) return false;
  if (!leaves() && !replay_ && soc_.end() == End::faulted) hold_at_fault();
  if (!replay_ || killed_) return false;
  if (replay_->begun) {  // the run has ended at the limit of the search, or earlier
    if (replay_->phase != Replay::Phase::searching) return false;
    next_replay();
  }
  replay_->begun = true;
  if (replay_->phase == Replay::Phase::restarting) {
    history_->restart(soc_);
    replay_->phase = Replay::Phase::seeking;
  } else {
    history_->restore(soc_, replay_->from);
  }
  history_->set_leaves(false);
  for (auto& hart : harts_) hart.forget();
  ended_ = false;
  return true;
}

void GdbServer::next_replay() {
  auto& replay = *replay_;
  if (replay.place.position != 0) {
    replay.phase = Replay::Phase::seeking;
  } else if (replay.from == 0) {
    replay.phase = Replay::Phase::seeking;
    replay.place = {.position = history_->snapshots().front().position + 1, .why = std::string(kAtBegin)};
  } else {
    replay.limit = history_->snapshots()[replay.from].position + 1;
    --replay.from;
  }
}

/// Called before a hart executes an instruction in a replay. Returns true if the hart continues, false if the run must
/// end here, and nullopt if gdb must stop here.
std::optional<bool> GdbServer::replay_before(unsigned number, std::uint32_t pc, std::uint64_t position) {
  auto& replay = *replay_;
  if (replay.phase == Replay::Phase::seeking) {
    if (position < replay.place.position) return true;
    stop(replay.place.hart.value_or(number), kTrap, replay.place.why);
    replay_.reset();
    return std::nullopt;
  }
  if (position >= replay.limit) {
    history_->set_leaves(true);
    return false;
  }
  if (replay.by_step ? number == replay.hart : breakpoints_.contains(pc)) {
    replay.place = {.position = position, .why = std::string(replay.by_step ? "" : kAtBreakpoint)};
  }
  return true;
}

/// Records a stop after an access to a word with a watchpoint. gdb assumes that a RISC-V core stops before the access.
/// Therefore gdb makes one more step in the same direction before it compares the values. The hart is recorded because
/// another hart may execute the next instruction.
void GdbServer::replay_retired(unsigned number, const Retired& instruction) {
  auto& replay = *replay_;
  if (replay.phase != Replay::Phase::searching || replay.by_step) return;
  if (auto touched = watch_touched(instruction.access); !touched.empty()) {
    replay.place = {.position = history_->position() + 1, .why = std::move(touched), .hart = number};
  }
}

}  // namespace mebots::soc::debug
