// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "debug/connection.hpp"
#include "debug/target.hpp"
#include "hart/observer.hpp"
#include "soc/soc.hpp"

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::soc::debug {

/// Lets gdb hold, look into and change the cores, each of which is a thread to it. While one is held, whoever runs the
/// chip waits in its observer's `before`: the whole simulation stands still, all cores with it. It goes on with the
/// same results when gdb has changed nothing.
class GdbServer {
 public:
  /// What gdb's `kill` means: the run ends, or it goes on without the debugger.
  enum class Kill : std::uint8_t { ends_run, detaches };

  /// Listens on 127.0.0.1 and says where through `announce`. The first instruction waits for a debugger.
  /// Throws Error when the port cannot be had.
  GdbServer(int port, Soc& soc, Kill kill, std::function<void(std::string_view)> announce);

  /// Who watches a hart, numbered as in the chip.
  Observer& hart(unsigned number) { return harts_[number]; }

  /// The program has ended: gdb hears it, and after a fault may look around first.
  void finish(int exit_code);

 private:
  struct Watch {
    std::uint32_t address = 0;
    std::uint32_t size = 0;
    char kind = '2';  // '2' stores, '3' loads, '4' both
    friend bool operator==(const Watch&, const Watch&) = default;
  };
  enum class Resume : std::uint8_t { no, run, step, end };

  class HartObserver final : public Observer {
   public:
    HartObserver(GdbServer& server, unsigned number) : server_(server), number_(number) {}
    bool before(const Hart& hart) override;
    void retired(const Hart& hart, const Retired& instruction) override;
    void trapped(const Hart& /*hart*/, const Trapped& /*trap*/) override { was_held_ = false; }
    void switched(const Hart& hart, bool on) override;

   private:
    bool reports_to_gdb() const { return !server_.only_hart_ || server_.only_hart_ == number_; }
    void hold(const Hart& hart);

    GdbServer& server_;
    unsigned number_;
    // It has been held before this instruction, which may come again: it let others go first, or sleeps before it.
    bool was_held_ = false;
    std::uint32_t held_pc_ = 0;
    std::uint64_t held_instructions_ = 0;  // instructions
  };

  bool accept_debugger();
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
  std::optional<unsigned> stepping_;   // the hart
  QuietCode step_range_;               // in which the step goes on; empty = one instruction
  std::optional<unsigned> only_hart_;  // likewise: gdb wants to hear of no other one meanwhile
  bool awaited_ = true;                // the run has not begun: wait for the debugger
  bool held_ = false;                  // gdb believes that the program stands
  bool killed_ = false;
  bool ended_ = false;
  std::uint32_t ticks_ = 0;
};

}  // namespace mebots::soc::debug
