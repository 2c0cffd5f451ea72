// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "debug/gdb_server.hpp"
#include "hart/observer.hpp"
#include "observe/power_trace.hpp"
#include "observe/profile.hpp"
#include "observe/trace.hpp"
#include "soc/soc.hpp"

#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::soc::observe {

/// Several observers as one, asked in the order of their coming.
class Observers final : public Observer {
 public:
  void add(Observer& observer) { list_.push_back(&observer); }
  void remove(const Observer& observer) { std::erase(list_, &observer); }
  bool empty() const { return list_.empty(); }

  bool before(const Hart& hart) override {
    for (auto* observer : list_) {
      if (!observer->before(hart)) return false;
    }
    return true;
  }
  void retired(const Hart& hart, const Retired& instruction) override {
    for (auto* observer : list_) observer->retired(hart, instruction);
  }
  QuietCode quiet() const override { return list_.size() == 1 ? list_.front()->quiet() : QuietCode{}; }
  /// Translated code has one who listens at most.
  const FlowMap* flow() const override { return list_.size() == 1 ? list_.front()->flow() : nullptr; }
  void flowed(const Hart& hart, std::span<const Flow> steps) override {
    for (auto* observer : list_) observer->flowed(hart, steps);
  }
  void trapped(const Hart& hart, const Trapped& trap) override {
    for (auto* observer : list_) observer->trapped(hart, trap);
  }
  void slept(const Hart& hart) override {
    for (auto* observer : list_) observer->slept(hart);
  }
  void woke(const Hart& hart) override {
    for (auto* observer : list_) observer->woke(hart);
  }
  void switched(const Hart& hart, bool on) override {
    for (auto* observer : list_) observer->switched(hart, on);
  }

 private:
  std::vector<Observer*> list_;
};

/// What a user wants to see of a run: a file each, or a port. `names` are the options or parameters that they stand in.
struct Requests {
  struct Names {
    std::string trace = "--trace";
    std::string profile = "--profile";
    std::string power_trace = "--power-trace";
  };
  Names names;
  std::optional<std::string> trace;
  Trace::Columns trace_columns;
  std::optional<std::string> profile;
  std::optional<std::string> power_trace;
  std::optional<int> gdb_port;
  debug::GdbServer::Kill gdb_kill = debug::GdbServer::Kill::ends_run;
  std::function<void(std::string_view)> announce;  // where gdb can call

  bool any() const { return trace || profile || power_trace || gdb_port; }
};

/// Those who watch a run. Lives no longer than its chip.
class Session {
 public:
  /// Throws Error when a file cannot be written or a port cannot be had.
  Session(const Requests& requests, Soc& soc);
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
  ~Session();

  /// One more who watches the fabric controller, until removed.
  void add(Observer& observer);
  void remove(Observer& observer);
  /// The chip was put into an earlier state.
  void restored();
  /// A span of time that the caller asked for is over.
  void stepped();
  /// The run has ended: writes what is left to write, tells the debugger.
  void finish(int exit_code);

 private:
  void attach(unsigned number);

  Soc& soc_;
  std::optional<Trace> trace_;
  std::optional<Profile> profile_;
  std::optional<PowerTrace> power_trace_;
  std::optional<debug::GdbServer> gdb_;
  std::deque<Observers> observers_;  // by hart
};

}  // namespace mebots::soc::observe
