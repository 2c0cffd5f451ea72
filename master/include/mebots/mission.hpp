// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/input_error.hpp"
#include "mebots/message.hpp"
#include "mebots/run_options.hpp"
#include "mebots/run_state.hpp"
#include "mebots/series.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mebots {

/// A run of an FMU, or of a system of FMUs that a config or an SSP describes. The results are those of `mebots run`.
///
/// Times are in seconds. Values are in the unit of their variable. Functions throw InputError for errors that the
/// caller can correct, and Error if the run fails. A failed run has the state `failed`, and its functions step() and
/// value() throw. Returned objects are copies.
///
/// Use a mission from one thread at a time; several missions can run on several threads. interrupt() may be called from
/// any thread.
class Mission {
 public:
  /// Reads and checks a config (.json), an FMU (.fmu) or an SSP (.ssp). Starts no FMU yet. If the mission is a
  /// single FMU, names of variables need no instance.
  explicit Mission(const std::filesystem::path& config, const RunOptions& options = {});
  /// Returns a mission that resumes from the last checkpoint in a results folder.
  static Mission resume(const std::filesystem::path& folder, bool in_memory = true);
  /// Closes the mission. A moved-from mission can only be destroyed or assigned to.
  ~Mission();
  Mission(Mission&& other) noexcept;
  Mission& operator=(Mission&& other) noexcept;

  // Functions to call before start().

  /// Sets the listener for messages of FMUs and for the run's own notices (instance ""). The listener is called during
  /// calls to FMUs. The listener may call interrupt(), but no other function of the mission. If the listener throws,
  /// the run fails when the call to the FMU returns.
  void on_message(std::function<void(const Message&)> listener);
  /// Sets the listener for communication points. The listener receives the time [s] of each point, including t = 0,
  /// after the point was recorded. It may read variables and interrupt() the run. It may write variables except at t =
  /// 0. If the listener throws, the run fails.
  void on_point(std::function<void(double)> listener);
  /// Replaces the config's parameter or start value of "instance.variable", or of all variables that match a pattern (*
  /// and ?). Checks name, type and limits immediately. Settings may come in any order: if structural parameters
  /// (FMI 3.0) determine the size of an array, start() checks whether the array has the element.
  void set(std::string_view variable, const Value& value);
  /// Adds the overrides of a scenario file. They follow the overrides of the config.
  void add_scenario(const std::filesystem::path& file);
  /// Connects the columns of a CSV file to the unconnected inputs with the same names. The file follows the config's
  /// `inputs`.
  void add_inputs(const std::filesystem::path& file);
  /// Sets the end of the run [s].
  void set_stop_time(double stop_time_s);
  /// Sets the variables to record (patterns with * and ?), in place of the config's `variables` and `exclude`.
  void record(const std::vector<std::string>& patterns);

  /// Unpacks and loads the FMUs without instantiating them. A process forked after load() can start the mission as a
  /// new process would.
  void load();

  /// Starts from a state that save_state() returned, not from t = 0. The results have the same bits as without
  /// interruption. The state may come from another process. Config, FMUs, settings and recorded variables must be the
  /// same. Must be called only for missions without the option `out`.
  void start_from(std::span<const std::byte> state);

  // Functions that run the mission. If the mission has not started, each function starts it.

  /// Opens the FMUs, checks the system, and initialises it at t = 0 or at the checkpoint.
  void start();
  /// Takes one communication step. Returns false if the end was already reached.
  bool step();
  /// Runs to the end. If the config or the options request "uncertainty", also runs 19 missions with drawn parameters,
  /// without messages and listeners, and adds their intervals to the summary. After write(), start_from() or an
  /// interrupt, these 19 missions are skipped. In this case `uncertainty.skipped` in the summary contains the reason.
  void run();
  /// Steps until `time_s` or the end of the run, whichever is earlier.
  void run_until(double time_s);
  /// Ends the run at the present point and writes its reports. Has no effect if the run has ended. A call from a
  /// listener acts as interrupt().
  void close() noexcept;
  /// Requests the end of the run, with the outcome "interrupted". The run ends between two calls to FMUs. A call to an
  /// isolated FMU is ended within 0.1 s. The run ends without an error. Safe in signal handlers.
  void interrupt() noexcept;

  /// Returns the mission's state between two steps, for start_from(), so that several runs can continue from one state.
  /// All FMUs must be able to serialize their state. Must be called only for missions without the option `out`, and not
  /// after the end of the run.
  std::vector<std::byte> save_state();

  /// Closes the mission and frees its instances. Returns the FMUs that are not clean, because they left data in this
  /// process that could change a later mission. Afterwards variables can be read only after reset().
  std::vector<Leftover> free_instances();

  /// Closes the mission and returns it to the state after the constructor: reads the config again and drops settings,
  /// scenarios, stop time, recorded variables and listeners. Clean FMUs stay unpacked and loaded. All other FMUs are
  /// loaded again. The results of the next run have the same bits as those of `mebots run`. If this process cannot
  /// guarantee that, start() throws an error that names the FMU. Must not be called for a resumed mission, nor from a
  /// listener.
  void reset();

  // Functions to call at any time.

  RunState state() const;
  double time_s() const;
  double step_s() const;
  double stop_time_s() const;
  /// True if the run has ended or failed.
  bool ended() const;
  /// Returns the outcome of the config whose conditions are true at the last point; "completed" if there is none. After
  /// an interrupt, close() or a failure, returns "interrupted", "closed" or "failed". Empty before the start.
  std::string outcome() const;
  /// Returns the reason for the end; empty before the end.
  std::optional<EndReason> end_reason() const;
  /// Returns a sentence with the reason for the end; empty before the end.
  std::string end_text() const;
  /// Returns the error message if the state is `failed`, else an empty text.
  std::string error() const;
  /// Returns the content of summary.json, as far as it exists, as JSON text; "{}" before the start.
  std::string summary() const;

  // Functions for variables. If the mission has not started, each function starts it.

  /// Returns the present value of a Real, Integer, enumeration or Boolean (0 or 1). After an interrupt in the middle of
  /// a step, some FMUs may already be at the end of this step, but the recorded results are not.
  double value(std::string_view variable);
  std::string text(std::string_view variable);
  /// Sets an unconnected input or a tunable parameter. summary.json lists the first 1000 written values under
  /// `inputs.writes`. The hash of the inputs does not include written values.
  void write(std::string_view variable, double value);

  // Functions for recorded values. They require the option `in_memory`. Texts are not kept in memory.

  /// Returns the names of the recorded variables in the order of the columns.
  std::vector<std::string> variables();
  /// Returns the times of the recorded points [s].
  std::vector<double> times();
  Series series(std::string_view variable);
  std::vector<Series> series();

 private:
  friend class InterruptOnSignals;
  class Impl;
  explicit Mission(std::unique_ptr<Impl> impl);

  std::unique_ptr<Impl> impl_;
};

/// While such objects exist, the first SIGINT, SIGTERM or SIGHUP interrupts the missions of all these objects. A second
/// signal ends the process immediately. The destructor restores the previous handlers. If `raise_again` is true, it
/// then raises the received signal again.
class InterruptOnSignals {
 public:
  /// `mission` must outlive this object and must not be moved during its lifetime.
  explicit InterruptOnSignals(Mission& mission, bool raise_again = false);
  ~InterruptOnSignals();
  InterruptOnSignals(const InterruptOnSignals&) = delete;
  InterruptOnSignals& operator=(const InterruptOnSignals&) = delete;

  /// Returns the received signal; 0 if there was none.
  int signal() const noexcept;

 private:
  class Guard;
  std::unique_ptr<Guard> guard_;
};

}  // namespace mebots
