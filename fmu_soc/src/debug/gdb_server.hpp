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

/// A server for gdb, which can stop, inspect and change the cores; each core is a thread. While a core is stopped, the
/// thread that runs the chip waits in the observer's before(), so the whole simulation waits. If gdb changes nothing,
/// results are the same as without gdb.
class GdbServer {
 public:
  /// The effect of gdb's `kill`: the run ends, or it continues without the debugger.
  enum class Kill : std::uint8_t { ends_run, detaches };

  /// Listens on 127.0.0.1 and passes the address to `announce`. The chip waits for a debugger before its first
  /// instruction. Throws Error if the port cannot be opened. If `history` is not null, gdb can go back in time. In this
  /// case, the caller must divide the run into pieces, and call checkpoint() before each piece. If rewind() returns
  /// true after the end of the run, the caller must continue the run.
  GdbServer(int port, Soc& soc, Kill kill, std::function<void(std::string_view)> announce, History* history = nullptr);

  /// Returns the observer of a hart. `number` is the hart's number in the chip.
  Observer& hart(unsigned number) { return harts_[number]; }

  /// Saves a state to which gdb can later go back.
  void checkpoint() {
    if (history_ != nullptr) history_->record(soc_);
  }
  /// If gdb wants to go back, restores an earlier state and returns true. If the run has ended with a fault, first
  /// waits for gdb's commands.
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
  static constexpr std::uint64_t kUnreachable = 0;  // a position before every saved state

  /// A method to go back in time; see reverse.cpp.
  struct Replay {
    enum class Phase : std::uint8_t { searching, seeking, restarting };
    struct Place {
      std::uint64_t position = 0;         // 0 = none
      std::string why = {};               // for the stop reply
      std::optional<unsigned> hart = {};  // that stops; otherwise the one that begins the instruction
    };

    Phase phase = Phase::searching;
    bool begun = false;
    std::size_t from = 0;     // state that it begins with
    std::uint64_t limit = 0;  // a search ends here
    bool by_step = false;     // a search for the last instruction of `hart`, not for a breakpoint
    unsigned hart = 0;
    Place place = {};  // where gdb is to stop
  };

  class HartObserver final : public Observer {
   public:
    HartObserver(GdbServer& server, unsigned number) : server_(server), number_(number) {}
    bool before(const Hart& hart) override;
    void retired(const Hart& hart, const Retired& instruction) override;
    void trapped(const Hart& /*hart*/, const Trapped& /*trap*/) override { was_held_ = false; }
    void switched(const Hart& hart, bool on) override;
    /// Called after an earlier state was restored. Forgets the last stop.
    void forget() { was_held_ = false; }

   private:
    bool reports_to_gdb() const { return !server_.only_hart_ || server_.only_hart_ == number_; }
    bool hold(const Hart& hart, std::uint64_t position);

    GdbServer& server_;
    unsigned number_;
    // The state at which this hart stopped last. A comparison shows whether the hart has returned to the same
    // instruction, after other harts ran or after a sleep.
    bool was_held_ = false;
    std::uint32_t held_pc_ = 0;
    std::uint64_t held_instructions_ = 0;
  };

  bool accept_debugger();
  /// True while the run ends so that rewind() can restore a state.
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
  std::optional<unsigned> stepping_;   // hart that gdb steps
  QuietCode step_range_;               // range in which the step continues; empty = one instruction
  std::optional<unsigned> only_hart_;  // if set, gdb only expects events of this hart
  bool awaited_ = true;                // the run has not begun: wait for the debugger
  bool held_ = false;                  // gdb assumes that the program is stopped
  bool killed_ = false;
  bool ended_ = false;
  std::uint32_t ticks_ = 0;
  History* history_ = nullptr;
  std::optional<Replay> replay_;
  std::uint64_t here_ = 0;                      // position at which gdb holds the program
  std::map<std::string, std::uint64_t> names_;  // places of `monitor save`
  std::string answer_;                          // to a monitor command that moves in time, sent on arrival
};

}  // namespace mebots::soc::debug
