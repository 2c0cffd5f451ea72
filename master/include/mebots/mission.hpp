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

/// A run of one FMU or of a system of FMUs. Computes the same results as the command `mebots run`.
///
/// Times are in seconds. Each value has the unit of its variable. Functions throw InputError for errors that the caller
/// can correct, and Error if the run fails. If the run has failed, state() returns `failed`, and step() and value()
/// throw.
///
/// Several threads must not use the same mission at the same time, except for interrupt(). Different missions can run
/// in different threads.
class Mission {
 public:
  /// Reads and checks a config (.json), an FMU (.fmu) or an SSP (.ssp). Does not instantiate the FMUs. If the mission
  /// consists of a single FMU, names of variables need no instance.
  explicit Mission(const std::filesystem::path& config, const RunOptions& options = {});
  /// Returns a mission that resumes from the last checkpoint in a results folder.
  static Mission resume(const std::filesystem::path& folder, bool in_memory = true);
  /// Closes the mission. A moved-from mission can only be destroyed or assigned to.
  ~Mission();
  Mission(Mission&& other) noexcept;
  Mission& operator=(Mission&& other) noexcept;

  // Functions to call before start().

  /// Sets the listener for messages of FMUs and of the run itself. The listener is called while an FMU's function is
  /// running. It must not call functions of the mission, except for interrupt(). If the listener throws, the run fails
  /// after the FMU's function has returned.
  void on_message(std::function<void(const Message&)> listener);
  /// Sets the listener that is called at each communication point, including t = 0, with the time in seconds. The
  /// values of the point are already recorded. The listener may read variables and call interrupt(). It may also write
  /// variables, but not at t = 0. If the listener throws, the run fails.
  void on_point(std::function<void(double)> listener);
  /// Sets a parameter or start value and replaces the value in the config. `variable` is "instance.variable"; * and ?
  /// select several variables. Throws InputError if the name, type or limits are wrong. If the size of an array depends
  /// on structural parameters (FMI 3.0), start() checks whether the element exists.
  void set(std::string_view variable, const Value& value);
  /// Adds the overrides of a scenario file after the overrides of the config.
  void add_scenario(const std::filesystem::path& file);
  /// Connects the columns of a CSV file to the unconnected inputs that have the same names.
  void add_inputs(const std::filesystem::path& file);
  /// Sets the time in seconds at which the run ends.
  void set_stop_time(double stop_time_s);
  /// Sets the patterns (with * and ?) of the variables to record. They replace `variables` and `exclude` of the config.
  void record(const std::vector<std::string>& patterns);

  /// Unpacks and loads the FMUs without instantiating them. A child process that is forked afterwards can start the
  /// mission like a new process.
  void load();

  /// Starts from a state that save_state() returned, possibly in another process. The results are bit-identical to
  /// those of an uninterrupted run. The config, FMUs, settings and recorded variables must be the same. The option
  /// `out` must not be set.
  void start_from(std::span<const std::byte> state);

  // Functions that run the mission. Each of them calls start() if the mission has not started.

  /// Opens the FMUs, checks the system, and initialises it at t = 0 or at the time of the checkpoint.
  void start();
  /// Takes one communication step. Returns false if the run has already reached its end.
  bool step();
  /// Runs to the end. If the config or the options request "uncertainty", then runs 19 more missions with randomly
  /// drawn parameters and writes intervals of the results to the summary. These missions are skipped after write(),
  /// start_from() or an interrupt; the summary then gives the reason in `uncertainty.skipped`.
  void run();
  /// Runs until `time_s` or to the end of the run, whichever is earlier.
  void run_until(double time_s);
  /// Ends the run at the current point and writes its reports. Has no effect if the run has ended. In a listener,
  /// close() has the same effect as interrupt().
  void close() noexcept;
  /// Requests the end of the run. The run ends after the current call to an FMU, with the outcome "interrupted". A call
  /// to an isolated FMU is aborted within 0.1 s. Can be called from any thread and from a signal handler.
  void interrupt() noexcept;

  /// Returns the state of the mission between two steps. Several missions can continue from this state with
  /// start_from(). All FMUs must be able to serialize their states. The option `out` must not be set. Must not be
  /// called after the end of the run.
  std::vector<std::byte> save_state();

  /// Closes the mission and frees its instances. Returns the FMUs that may have left data in this process that affects
  /// a later mission. Afterwards, variables can be read only after reset().
  std::vector<Leftover> free_instances();

  /// Closes the mission and restores the state after the constructor. Reads the config again. Discards settings,
  /// scenarios, stop time, recorded variables and listeners. The results of the next run are bit-identical to those of
  /// a new process. If this cannot be guaranteed, start() throws an error that names the FMU. Must not be called for a
  /// resumed mission or by a listener.
  void reset();

  // Functions to call at any time.

  RunState state() const;
  double time_s() const;
  double step_s() const;
  double stop_time_s() const;
  /// True if the run has ended or failed.
  bool ended() const;
  /// Returns the outcome in the config whose conditions are true at the last point, or "completed" if there is none.
  /// After an interrupt, close() or a failure, returns "interrupted", "closed" or "failed". Empty before the start.
  std::string outcome() const;
  /// Returns the reason for the end of the run; nullopt before the end.
  std::optional<EndReason> end_reason() const;
  /// Returns the reason for the end of the run as a sentence; an empty text before the end.
  std::string end_text() const;
  /// Returns the error message of a failed run, otherwise an empty text.
  std::string error() const;
  /// Returns the present content of summary.json as JSON text; "{}" before the start.
  std::string summary() const;

  // Functions for variables. Each of them calls start() if the mission has not started.

  /// Returns the present value of a Real, Integer, enumeration or Boolean (0 or 1). After an interrupt during a step,
  /// some FMUs may already have completed this step. Their values are then later than the recorded values.
  double value(std::string_view variable);
  std::string text(std::string_view variable);
  /// Sets an unconnected input or a tunable parameter. summary.json lists the first 1000 written values under
  /// `inputs.writes`. Written values do not affect the hash of the inputs.
  void write(std::string_view variable, double value);

  // Functions for recorded values. They require the option `in_memory`. Values of Strings are not available.

  /// Returns the names of the recorded variables in the order in which they are recorded.
  std::vector<std::string> variables();
  /// Returns the times of the recorded points in seconds.
  std::vector<double> times();
  Series series(std::string_view variable);
  std::vector<Series> series();

 private:
  friend class InterruptOnSignals;
  class Impl;
  explicit Mission(std::unique_ptr<Impl> impl);

  std::unique_ptr<Impl> impl_;
};

/// Interrupts missions on SIGINT, SIGTERM or SIGHUP. The first signal interrupts the missions of all such objects that
/// exist. A second signal ends the process. The destructor restores the previous signal handlers. If `raise_again` is
/// true, the destructor then raises the received signal again.
class InterruptOnSignals {
 public:
  /// `mission` must exist longer than this object and must not be moved.
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
