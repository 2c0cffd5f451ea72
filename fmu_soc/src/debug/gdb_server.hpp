// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "debug/connection.hpp"
#include "debug/history.hpp"
#include "debug/target.hpp"
#include "hart/observer.hpp"
#include "soc/soc.hpp"

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::soc::debug {

/// Lets gdb stop, inspect and change the cores. Each core appears as a thread. While gdb holds a core, the simulation
/// does not advance, because Observer::before() blocks the thread that runs the chip. If gdb changes nothing, the
/// results are the same as without gdb.
class GdbServer {
 public:
  /// Selects whether gdb's command `kill` ends the run, or only disconnects the debugger.
  enum class Kill : std::uint8_t { ends_run, detaches };

  /// Listens on 127.0.0.1 and reports the port through `announce`. The chip waits for a debugger before its first
  /// instruction. Throws Error if the port cannot be opened.
  ///
  /// If `history` is not null, gdb can return to earlier instructions. The caller must then divide the run into pieces
  /// and call checkpoint() before each piece. After each end of the run, the caller must call rewind(), and continue
  /// the run if rewind() returns true.
  GdbServer(int port, Soc& soc, Kill kill, std::function<void(std::string_view)> announce, History* history = nullptr);

  /// Returns the observer to attach to the hart `number`.
  Observer& hart(unsigned number) { return harts_[number]; }

  /// Saves the chip's state, so that gdb can return to it. Without a history, has no effect.
  void checkpoint() {
    if (history_ != nullptr) history_->record(soc_);
  }
  /// If gdb has requested an earlier instruction, restores a saved state and returns true. If the run has ended with a
  /// fault, first waits for gdb's commands.
  bool rewind();

  /// Reports the end of the program to gdb. If the end is a fault, gdb can inspect the chip before the run ends.
  void finish(int exit_code);

 private:
  struct Watch {
    std::uint32_t address = 0;
    std::uint32_t size = 0;
    char kind = '2';  // '2' stores, '3' loads, '4' both
    friend bool operator==(const Watch&, const Watch&) = default;
  };
  enum class Resume : std::uint8_t { no, run, step, end, rewind };
  static constexpr std::string_view kTrap = "T05";
  static constexpr std::string_view kAtBreakpoint = "swbreak:;";
  static constexpr std::uint64_t kUnreachable = 0;  // position before every saved state

  /// Describes a replay: the chip returns to a saved state, and runs from there to the instruction at which gdb must
  /// stop. See reverse.cpp.
  struct Replay {
    enum class Phase : std::uint8_t { searching, seeking, restarting };
    struct Place {
      std::uint64_t position = 0;  // instruction at which to stop; 0 = none
      std::string why = {};
      std::optional<unsigned> hart = {};  // hart that stops; empty = the hart that begins the instruction
    };

    Phase phase = Phase::searching;
    bool begun = false;
    std::size_t from = 0;     // index of the saved state that the replay starts from
    std::uint64_t limit = 0;  // position at which a search ends
    bool by_step = false;     // if true, searches for the last instruction of `hart` instead of a breakpoint
    unsigned hart = 0;
    Place place = {};  // position at which the program must stop for gdb
  };

  class HartObserver final : public Observer {
   public:
    HartObserver(GdbServer& server, unsigned number) : server_(server), number_(number) {}
    bool before(const Hart& hart) override;
    void retired(const Hart& hart, const Retired& instruction) override;
    void trapped(const Hart& /*hart*/, const Trapped& /*trap*/) override { was_held_ = false; }
    void switched(const Hart& hart, bool on) override;
    /// Discards the state of this hart's last stop. Must be called after the chip was restored to an earlier state.
    void forget() { was_held_ = false; }

   private:
    bool reports_to_gdb() const { return !server_.only_hart_ || server_.only_hart_ == number_; }
    bool hold(const Hart& hart, std::uint64_t position);

    GdbServer& server_;
    unsigned number_;
    // State of the hart at its last stop. If the hart still has this state, before() was called again for the same
    // instruction, for example after a sleep.
    bool was_held_ = false;
    std::uint32_t held_pc_ = 0;
    std::uint64_t held_instructions_ = 0;
  };

  bool accept_debugger();
  /// Returns true if the run must end so that rewind() can restore a state.
  bool leaves() const { return history_ != nullptr && history_->leaves(); }
  void hold_at_fault();
  std::optional<std::size_t> state_before(std::uint64_t position) const;
  Resume reverse(bool by_step);
  std::optional<Resume> travel(std::string_view command);
  void next_replay();
  std::optional<bool> replay_before(unsigned number, std::uint32_t pc, std::uint64_t position);
  void replay_retired(unsigned number, const Retired& instruction);
  void stop(unsigned number, std::string_view signal, std::string_view why = {});
  Resume serve();
  Resume obey(const std::string& packet);
  Resume resume(std::string_view actions);
  std::string answer(const std::string& packet);
  std::string query(std::string_view text);
  std::string monitor(std::string_view command) const;
  std::string read_registers() const;
  std::string read_register(unsigned number) const;
  bool write_register(unsigned number, std::uint32_t value);
  void end_history();
  std::string read_memory(std::string_view text) const;
  std::string write_memory(std::string_view text, bool binary);
  std::string change_point(std::string_view text, bool insert);
  bool ends_step(unsigned number, std::uint32_t pc) const { return stepping_ == number && !step_range_.holds(pc); }
  std::string watch_touched(const Access& access) const;

  Soc& soc_;
  Kill kill_;
  Connection connection_;
  std::function<void(std::string_view)> announce_;
  Threads threads_;
  std::deque<HartObserver> harts_;
  std::set<std::uint32_t> breakpoints_;
  std::vector<Watch> watches_;
  std::string stop_reply_;
  std::optional<unsigned> stepping_;  // hart that gdb is single-stepping
  QuietCode step_range_;  // addresses in which a single step continues; empty = the step ends after one instruction
  std::optional<unsigned> only_hart_;  // if set, gdb expects stops of this hart only
  bool awaited_ = true;                // true until the first debugger has connected
  bool held_ = false;                  // true while gdb assumes that the program is stopped
  bool killed_ = false;
  bool ended_ = false;
  std::uint32_t ticks_ = 0;
  History* history_ = nullptr;
  std::optional<Replay> replay_;
  std::uint64_t here_ = 0;                      // position at which the program is stopped for gdb
  std::map<std::string, std::uint64_t> names_;  // positions that `monitor save` has named
  std::string answer_;  // reply to a monitor command that moves in time; sent when the position is reached
};

}  // namespace mebots::soc::debug
