// SPDX-License-Identifier: Apache-2.0
//
// Decides when a hart stops for gdb, and builds the stop replies.
#include "debug/gdb_server.hpp"

#include <fmt/core.h>

#include <utility>

namespace mebots::soc::debug {
namespace {

/// Number of instructions between two checks for Ctrl-C or a new debugger.
constexpr std::uint32_t kPollInterval = 1U << 12;
constexpr std::string_view kInterrupted = "T02";

}  // namespace

void GdbServer::stop(unsigned number, std::string_view signal, std::string_view why) {
  threads_.choose(number);
  stop_reply_ = fmt::format("{}thread:{:x};{}", signal, number + 1, why);
}

bool GdbServer::HartObserver::before(const Hart& hart) {
  auto& server = server_;
  auto& connection = server.connection_;
  if (server.killed_ || server.leaves()) return false;
  const auto position = server.history_ == nullptr ? 0 : server.history_->advance();
  if (server.replay_) {
    if (const auto runs = server.replay_before(number_, hart.pc(), position)) return *runs;
    return hold(hart, position);
  }
  const bool look = (++server.ticks_ & (kPollInterval - 1)) == 0;
  if (look && connection.connected()) connection.refuse_others();
  // NOLINTBEGIN(bugprone-branch-clone): the order of the conditions matters
  if (!connection.connected()) {
    if (!(server.awaited_ || look) || !server.accept_debugger()) return true;
    server.stop(number_, kTrap);
    server.held_ = true;  // gdb will query the reason for the stop
  } else if (look && connection.interrupted()) {
    server.stop(server.only_hart_.value_or(number_), kInterrupted);
  } else if (was_held_ && hart.pc() == held_pc_ && hart.counters().instructions == held_instructions_) {
    return true;
  } else if (server.ends_step(number_, hart.pc())) {
    server.stop(number_, kTrap);  // a handler was entered, so that the instruction itself has not retired
  } else if (reports_to_gdb() && server.breakpoints_.contains(hart.pc())) {
    server.stop(number_, kTrap, kAtBreakpoint);
  } else {
    return true;
  }
  // NOLINTEND(bugprone-branch-clone)
  return hold(hart, position);
}

/// Ends gdb's step of this hart and reports a watchpoint before any other hart continues, because gdb expects only one
/// thread to run during a step.
void GdbServer::HartObserver::retired(const Hart& hart, const Retired& instruction) {
  if (server_.replay_) return server_.replay_retired(number_, instruction);
  if (server_.leaves() || !server_.connection_.connected() || !reports_to_gdb()) return;
  const auto touched = server_.watch_touched(instruction.access);
  if (!touched.empty() || server_.ends_step(number_, hart.pc())) {
    server_.stop(number_, kTrap, touched);
  } else if ((server_.only_hart_ == number_ || server_.stepping_ == number_) &&
             server_.breakpoints_.contains(hart.pc())) {
    server_.stop(number_, kTrap, kAtBreakpoint);
  } else {
    return;
  }
  hold(hart, server_.history_ == nullptr ? 0 : server_.history_->position() + 1);
}

/// Ends gdb's step of this hart, because a hart that is switched off executes no further instruction.
void GdbServer::HartObserver::switched(const Hart& /*hart*/, bool /*on*/) {
  was_held_ = false;
  if (server_.stepping_ == number_) server_.stepping_.reset();
  if (server_.only_hart_ == number_) server_.only_hart_.reset();
}

/// Stops the hart for gdb. `position` is the position of its next instruction. Returns false if the run must end here.
bool GdbServer::HartObserver::hold(const Hart& hart, std::uint64_t position) {
  server_.here_ = position;
  server_.killed_ = server_.serve() == Resume::end;
  was_held_ = true;
  held_pc_ = hart.pc();
  held_instructions_ = hart.counters().instructions;
  return !server_.killed_ && !server_.leaves();
}

/// Returns the watchpoint that the access touches, in gdb's format. If the access touches no watchpoint, returns an
/// empty text.
std::string GdbServer::watch_touched(const Access& access) const {
  if (access.size == 0) return {};
  for (const auto& watch : watches_) {
    if ((watch.kind == '2' && !access.writes) || (watch.kind == '3' && !access.reads)) continue;
    if (access.address < std::uint64_t{watch.address} + watch.size &&
        watch.address < std::uint64_t{access.address} + access.size) {
      const auto* name = watch.kind == '2' ? "watch" : watch.kind == '3' ? "rwatch" : "awatch";
      return fmt::format("{}:{:08x};", name, watch.address);
    }
  }
  return {};
}

}  // namespace mebots::soc::debug
