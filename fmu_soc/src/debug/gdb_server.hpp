// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "debug/connection.hpp"
#include "hart/observer.hpp"
#include "soc.hpp"

#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::soc::debug {

/// Lets gdb hold, look into and change the core. While it is held, whoever runs the chip waits in `before`: the whole
/// simulation stands still, and goes on with the same results when gdb has changed nothing.
class GdbServer final : public Observer {
 public:
  /// What gdb's `kill` means: the run ends, or it goes on without the debugger.
  enum class Kill : std::uint8_t { ends_run, lets_go };

  /// Listens on 127.0.0.1 and says where through `announce`. The first instruction waits for a debugger.
  /// Throws Error when the port cannot be had.
  GdbServer(int port, Soc& soc, Kill kill, std::function<void(std::string_view)> announce);

  bool before(Hart& hart) override;
  void retired(const Hart& hart, const Retired& instruction) override;
  void trapped(const Hart& /*hart*/, const Trapped& /*trap*/) override { resumed_ = false; }

  /// The program has ended: gdb hears it, and after a fault may look around first.
  void finish(int exit_code);

 private:
  struct Watch {
    std::uint32_t address = 0;
    std::uint32_t size = 0;
    char kind = '2';  // '2' stores, '3' loads, '4' both
    friend bool operator==(const Watch&, const Watch&) = default;
  };
  enum class Resume : std::uint8_t { no, go_on, step, end };

  bool meet_debugger();
  Resume serve();
  Resume obey(const std::string& packet);
  std::string answer(const std::string& packet);
  std::string query(std::string_view text);
  std::string monitor(std::string_view command) const;
  std::string read_registers() const;
  std::string read_register(unsigned number) const;
  bool write_register(unsigned number, std::uint32_t value);
  std::string read_memory(std::string_view text) const;
  std::string write_memory(std::string_view text, bool binary);
  std::string change_point(std::string_view text, bool insert);

  Soc& soc_;
  Kill kill_;
  Connection connection_;
  std::function<void(std::string_view)> announce_;
  std::set<std::uint32_t> breakpoints_;
  std::vector<Watch> watches_;
  std::string stop_reply_;
  std::string watch_reply_;  // a watched place was touched by the last instruction
  bool awaited_ = true;      // the run has not begun: wait for the debugger
  bool stepping_ = false;
  bool held_ = false;  // gdb believes that the program stands
  bool ended_ = false;
  std::uint32_t ticks_ = 0;
  // An instruction that must let others go first comes again before it retires: it has been stopped at already.
  std::uint32_t resumed_pc_ = 0;
  std::uint64_t resumed_instructions_ = 0;
  bool resumed_ = false;
};

}  // namespace mebots::soc::debug
