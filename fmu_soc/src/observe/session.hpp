// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "debug/gdb_server.hpp"
#include "hart/observer.hpp"
#include "observe/coverage.hpp"
#include "observe/cycle_stack.hpp"
#include "observe/pipeline_trace.hpp"
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

/// Combines several observers. They are called in the order in which they were added.
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
  /// Steps between functions are only supported for a single observer. If there are several observers, translated code
  /// cannot be used.
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

/// Combines several listeners; they are called in the order in which they were added.
class StateListeners final : public StateListener {
 public:
  void add(StateListener& listener) { list_.push_back(&listener); }
  void changed(Picoseconds time) override {
    for (auto* listener : list_) listener->changed(time);
  }

 private:
  std::vector<StateListener*> list_;
};

/// The recordings that a user has requested of a run: files, or a port. `names` are the options or parameters of these
/// requests, for messages.
struct Requests {
  struct Names {
    std::string trace = "--trace";
    std::string profile = "--profile";
    std::string power_trace = "--power-trace";
    std::string coverage = "--coverage";
    std::string pipeline = "--pipeline";
  };
  Names names;
  std::optional<std::string> trace;
  Trace::Columns trace_columns;
  std::optional<std::string> profile;
  std::optional<std::string> power_trace;
  bool cycle_stack = false;  // cycles by cause: Session::cycle_stack()
  std::optional<std::string> coverage;
  std::optional<std::string> pipeline;
  unsigned pipeline_hart = kFabricControllerHart;
  std::optional<int> gdb_port;
  debug::GdbServer::Kill gdb_kill = debug::GdbServer::Kill::ends_run;
  debug::History* history = nullptr;               // for steps of gdb into the past; must outlive the session
  std::function<void(std::string_view)> announce;  // prints the port for gdb

  /// True if a recording other than the connection for gdb was requested.
  bool writes() const { return trace || profile || power_trace || cycle_stack || coverage || pipeline; }
  bool any() const { return writes() || gdb_port; }
};

/// The observers of a run. The chip must outlive the session.
class Session {
 public:
  /// Throws Error if a file cannot be written or a port cannot be opened.
  Session(const Requests& requests, Soc& soc);
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
  ~Session();

  /// Adds an observer of the fabric controller until it is removed.
  void add(Observer& observer);
  void remove(Observer& observer);
  /// Adds a listener, which must outlive the session.
  void listen(StateListener& listener);
  /// Called after the chip was restored to an earlier state.
  void restored();
  /// These two functions call GdbServer::checkpoint() and GdbServer::rewind().
  void checkpoint();
  bool rewind();
  /// Ends a step of the caller.
  void stepped();
  /// Completes the files at the end of the run, and reports the end to the debugger.
  void finish(int exit_code);
  /// Returns the cycles by cause; null if they were not requested. They are complete after finish().
  const CycleStack* cycle_stack() const { return cycle_stack_ ? &*cycle_stack_ : nullptr; }

 private:
  void attach(unsigned number);

  Soc& soc_;
  std::optional<Trace> trace_;
  std::optional<Profile> profile_;
  std::optional<PowerTrace> power_trace_;
  std::optional<CycleStack> cycle_stack_;
  std::optional<Coverage> coverage_;
  std::optional<PipelineTrace> pipeline_;
  std::optional<debug::GdbServer> gdb_;
  std::deque<Observers> observers_;  // by hart
  StateListeners listeners_;
};

}  // namespace mebots::soc::observe
