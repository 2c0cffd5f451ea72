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

/// Combines several observers, which are called in the order in which they were added.
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
  /// Returns null if there are several observers, because only a single observer can receive recorded steps. Code is
  /// then not translated.
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

class StateListeners final : public StateListener {
 public:
  void add(StateListener& listener) { list_.push_back(&listener); }
  void changed(Picoseconds time) override {
    for (auto* listener : list_) listener->changed(time);
  }

 private:
  std::vector<StateListener*> list_;
};

/// Lists the recordings of a run that the user has requested: files, or a port for gdb. `names` contains the options or
/// parameters that made these requests, for error messages.
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
  bool cycle_stack = false;  // count cycles for each cause; see Session::cycle_stack()
  std::optional<std::string> coverage;
  std::optional<std::string> pipeline;
  unsigned pipeline_hart = kFabricControllerHart;
  std::optional<int> gdb_port;
  debug::GdbServer::Kill gdb_kill = debug::GdbServer::Kill::ends_run;
  /// Lets gdb return to earlier instructions; may be null; must outlive the session.
  debug::History* history = nullptr;
  std::function<void(std::string_view)> announce;  // prints the port on which gdb can connect

  /// Returns true if at least one recording was requested, apart from the connection for gdb.
  bool writes() const { return trace || profile || power_trace || cycle_stack || coverage || pipeline; }
  bool any() const { return writes() || gdb_port; }
};

/// Contains all observers of a run. The chip must outlive the session.
class Session {
 public:
  /// Throws Error if a file cannot be written or a port cannot be opened.
  Session(const Requests& requests, Soc& soc);
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
  ~Session();

  /// Adds an observer of the fabric controller. The caller must remove the observer before it is destroyed.
  void add(Observer& observer);
  void remove(Observer& observer);
  /// Adds a listener, which must outlive the session.
  void listen(StateListener& listener);
  /// Must be called after the chip was restored to an earlier state.
  void restored();
  /// Call GdbServer::checkpoint() and GdbServer::rewind(), if there is a connection for gdb.
  void checkpoint();
  bool rewind();
  /// Must be called each time the caller has run the chip, for example after each communication step.
  void stepped();
  /// Completes the files and reports the end of the run to the debugger.
  void finish(int exit_code);
  /// Returns the cycles of each cause, or null if they were not requested. They are complete after finish().
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
  std::deque<Observers> observers_;  // indexed by hart number
  StateListeners listeners_;
};

}  // namespace mebots::soc::observe
