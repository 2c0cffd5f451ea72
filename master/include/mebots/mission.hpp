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

/// A run of an FMU, or of an ensemble of FMUs that a config or an SSP describes: the same run as `mebots run` makes,
/// step by step.
///
/// Times are in seconds, values in the unit of their variable. Everything throws InputError for what the caller can
/// mend and Error for a run that went wrong; after the latter the run is `failed`, and step() and value() throw.
/// What is returned is a copy and belongs to the caller.
///
/// One thread at a time per mission; several missions on several threads. interrupt() from any thread.
class Mission {
 public:
  /// Reads and checks a config (.json), an FMU (.fmu) or an SSP 1.0 (.ssp). No FMU is started yet. The names of an
  /// FMU's variables need no instance in front.
  explicit Mission(const std::filesystem::path& config, const RunOptions& options = {});
  /// A mission that goes on from the last checkpoint in a results folder.
  static Mission resume(const std::filesystem::path& folder, bool in_memory = true);
  /// Closes the mission. One that was moved from can only be destroyed or assigned to.
  ~Mission();
  Mission(Mission&& other) noexcept;
  Mission& operator=(Mission&& other) noexcept;

  // Before start().

  /// Hears what FMUs say, and the run's own notices (instance ""), from within the calls to FMUs: do not call the
  /// mission back, except for interrupt(). An exception from it fails the run once the FMU's call is over.
  void on_message(std::function<void(const Message&)> listener);
  /// Hears of every communication point with its time [s], t = 0 included, after the point was recorded. It may read
  /// and write variables, but for t = 0, and interrupt() the run. An exception from it fails the run.
  void on_point(std::function<void(double)> listener);
  /// A parameter or start value for "instance.variable", in place of the config's. Name, type and limits are checked at
  /// once.
  void set(std::string_view variable, const Value& value);
  /// Overrides from a file, after those of the config.
  void add_scenario(const std::filesystem::path& file);
  /// Takes the columns of a CSV file as sources of the free inputs that they are named after, after the config's.
  void add_inputs(const std::filesystem::path& file);
  /// The end of the run [s].
  void set_stop_time(double stop_time_s);
  /// Records these variables (patterns with * and ?) in place of the config's `variables` and `exclude`.
  void record(const std::vector<std::string>& patterns);

  /// Unpacks and loads the FMUs, and makes no instance. A process that is forked from here begins the mission as a
  /// fresh one.
  void load();

  /// Begins where save_state() of a mission with the same config, FMUs, settings and choice of what is recorded was
  /// called, in this process or another, in place of t = 0. It goes on to the same bits. Missions without `out` only.
  void start_from(std::span<const std::byte> state);

  // The run. Each starts the mission if that was not done.

  /// Opens the FMUs, checks everything that can be checked, and goes to t = 0 (or to the checkpoint).
  void start();
  /// One communication step. False when no step was taken, because the end was reached.
  bool step();
  /// To the end. If the config or the options ask for "uncertainty", 19 flights with drawn parameters follow, without
  /// messages and listeners, and the summary gets their intervals. There are none after write(), start_from() or an
  /// interrupt: the summary's `uncertainty.skipped` has the reason.
  void run();
  /// Steps until `time_s`, or to the end when that comes first.
  void run_until(double time_s);
  /// Ends the run where it stands and writes its reports. Nothing, when it is over. From a listener: as interrupt().
  void close() noexcept;
  /// Asks for the end: between two calls to FMUs, and within 0.1 s in a call to an isolated one. The run then ends
  /// well, with outcome "interrupted". Safe in signal handlers.
  void interrupt() noexcept;

  /// The mission as it stands between two steps, for start_from(): many futures of one past. All its FMUs must be able
  /// to write their state as bytes; missions without `out` only, and not after the end.
  std::vector<std::byte> save_state();

  /// Closes the mission and frees its instances. Lists the FMUs that are not clean: a mission after it in this process
  /// might find what they left. Only reset() makes variables readable again.
  std::vector<Leftover> free_instances();

  /// Closes the mission and makes it one that was just opened. What was asked for after the constructor (settings,
  /// scenarios, stop time, choice of what is recorded, listeners) is forgotten, the config is read again. FMUs stay
  /// unpacked and loaded if they are clean; others are loaded again. The next run is, to the last bit, that of
  /// `mebots run`; if that is not possible in this process, start() refuses it and names the FMU. Not for one that was
  /// resumed, and not from a listener.
  void reset();

  // At any time.

  RunState state() const;
  double time_s() const;
  double step_s() const;
  double stop_time_s() const;
  /// Over, well or not.
  bool ended() const;
  /// The config's outcome at the point reached last, "completed" when none of its conditions hold; "interrupted",
  /// "closed" and "failed" for a run that was. Empty before the start.
  std::string outcome() const;
  /// Nothing before the end.
  std::optional<EndReason> end_reason() const;
  /// One sentence on why the run ended; empty before.
  std::string end_text() const;
  /// What went wrong; empty unless `failed`.
  std::string error() const;
  /// The content of summary.json as JSON text, as far as it is known: "{}" before the start.
  std::string summary() const;

  // Variables, from the start on (start() is done if need be).

  /// The value now: Reals, Integers, enumerations, Booleans as 0 and 1. After an interrupt in the middle of a step some
  /// FMUs stand at its end already; what was recorded does not have that.
  double value(std::string_view variable);
  std::string text(std::string_view variable);
  /// Sets an input that nothing is connected to, or a tunable parameter, from now on. summary.json lists it under
  /// `inputs.writes`; the hash of the inputs does not know of it.
  void write(std::string_view variable, double value);

  // What was recorded so far, with `in_memory`. Texts are not kept in memory.

  /// Names of the recorded variables, in the order of the columns.
  std::vector<std::string> variables();
  /// The times of the recorded points [s].
  std::vector<double> times();
  Series series(std::string_view variable);
  std::vector<Series> series();

 private:
  friend class InterruptOnSignals;
  class Door;
  explicit Mission(std::unique_ptr<Door> door);

  std::unique_ptr<Door> door_;
};

/// While it lives, the first SIGINT, SIGTERM or SIGHUP of the process interrupts the mission (and all others that have
/// one of these); the second ends the process at once. Afterwards the handlers are those of before; with `raise_again`
/// they then hear of the signal.
class InterruptOnSignals {
 public:
  /// `mission` must outlive this object and must not be moved meanwhile.
  explicit InterruptOnSignals(Mission& mission, bool raise_again = false);
  ~InterruptOnSignals();
  InterruptOnSignals(const InterruptOnSignals&) = delete;
  InterruptOnSignals& operator=(const InterruptOnSignals&) = delete;

  /// The signal that came; 0 = none.
  int signal() const noexcept;

 private:
  class Guard;
  std::unique_ptr<Guard> guard_;
};

}  // namespace mebots
