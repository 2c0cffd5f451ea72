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

/// Serves gdb, which can stop, inspect and change the cores. Each core appears as a thread. While a core is stopped,
/// the simulation waits, because the thread that runs the chip waits in the observer's before(). If gdb changes
/// nothing, results are the same as without gdb.
class GdbServer {
 public:
  /// Selects the effect of gdb's command `kill`: the run ends, or the run continues without the debugger.
  enum class Kill : std::uint8_t { ends_run, detaches };

  /// Listens on 127.0.0.1 and passes the address to `announce`. The chip waits for a debugger before its first
  /// instruction. Throws Error if the port cannot be opened. If `history` is not null, gdb can return to earlier
  /// instructions. In this case, the caller must divide the run into pieces, and must call checkpoint() before each
  /// piece. If rewind() returns true after the end of the run, the caller must continue the run.
  GdbServer(int port, Soc& soc, Kill kill, std::function<void(std::string_view)> announce, History* history = nullptr);

  /// Returns the observer that must be attached to the hart `number`.
  Observer& hart(unsigned number) { return harts_[number]; }

  /// Saves the state of the chip, if there is a history. gdb can later return to this state.
  void checkpoint() {
    if (history_ != nullptr) history_->record(soc_);
  }
  /// Restores an earlier state and returns true if gdb has requested an earlier instruction. If the run has ended with
  /// a fault, first waits for gdb's commands.
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
  static constexpr std::uint64_t kUnreachable = 0;  // position that is earlier than every saved state

  /// Describes how an earlier instruction is reached by running again from a saved state; see reverse.cpp.
  struct Replay {
    enum class Phase : std::uint8_t { searching, seeking, restarting };
    struct Place {
      std::uint64_t position = 0;         // instruction at which to stop; 0 = none
      std::string why = {};               // reason that the stop reply contains
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
    /// Discards the last stop. Called after an earlier state was restored.
    void forget() { was_held_ = false; }

   private:
    bool reports_to_gdb() const { return !server_.only_hart_ || server_.only_hart_ == number_; }
    bool hold(const Hart& hart, std::uint64_t position);

    GdbServer& server_;
    unsigned number_;
    // Store the state at which this hart stopped last. If the state is unchanged, the hart has returned to the same
    // instruction, for example after other harts ran or after a sleep.
    bool was_held_ = false;
    std::uint32_t held_pc_ = 0;
    std::uint64_t held_instructions_ = 0;
  };

  bool accept_debugger();
  /// Returns true while the run is being ended so that rewind() can restore a state.
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
  bool awaited_ = true;                // true until a debugger has connected before the first instruction
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
