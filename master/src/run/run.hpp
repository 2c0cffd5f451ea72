// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmi/call/exit_guard.hpp"
#include "fmi/call/forked_copies.hpp"
#include "mebots/run_options.hpp"
#include "mebots/run_state.hpp"
#include "message/message_hub.hpp"
#include "model/statistics.hpp"
#include "record/conditions.hpp"
#include "record/coupling.hpp"
#include "record/recorder.hpp"
#include "record/scenario.hpp"
#include "record/sink/memory_sink.hpp"
#include "resolve/resolve.hpp"
#include "run/checkpoint.hpp"
#include "run/clean_fmus.hpp"
#include "run/input_hash.hpp"
#include "run/live_scenario.hpp"
#include "run/result_files.hpp"
#include "run/setting_names.hpp"
#include "run/simulation.hpp"
#include "run/summary.hpp"
#include "run/write_saver.hpp"

#include <nlohmann/json_fwd.hpp>

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::master {

/// A run of a system, from its options to its report. The command line, the C++ interface and the Python package use
/// this class.
///
/// If a function such as start() or step() fails, it throws and sets the state to `failed`. The files then contain the
/// results up to this point. A failed run calls no FMU, and its step() throws.
///
/// At each communication point, observers are called in this order: scenario, result files, pictures, recorder, summary
/// values, outcomes, stop conditions, coupling, observers of add(), checkpointer. Therefore a checkpoint contains the
/// states of all other observers.
///
/// Only one thread at a time may use a run, except for interrupt(), which is safe in any thread and in signal handlers.
class Run {
 public:
  /// Reads the config and applies the options. Creates no files. Does not open FMUs again that `library` already
  /// contains. Throws InputError if the config or an option is invalid.
  explicit Run(const std::filesystem::path& config, RunOptions options = {},
               std::shared_ptr<FmuLibrary> library = std::make_shared<FmuLibrary>());
  /// Returns the run of the checkpoint in this folder. start() restores its state. Throws InputError if the checkpoint
  /// cannot be resumed.
  static std::unique_ptr<Run> resume(const std::filesystem::path& folder, bool in_memory = false);
  /// Calls close().
  ~Run();
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  // The following functions must be called before start().

  /// Adds a listener for messages of FMUs and of the run.
  void listen(MessageHub::Listener listener);
  /// Sets a parameter or start value, or all variables that match a pattern (* and ?). Opens the FMUs and checks name,
  /// type and range. If other settings can change the size of an array, start() checks whether a named array element
  /// exists. After a change of a size, the patterns of earlier calls also match the new elements.
  void set(const Setting& written);
  /// Appends the overrides of a scenario file.
  void add_scenario(const std::filesystem::path& file);
  /// Connects the columns of a CSV file to the unconnected inputs with the same names.
  void add_inputs(const std::filesystem::path& file);
  void set_stop_time(std::int64_t stop_time_ns, const std::string& place);
  /// Records the variables that match these patterns (* and ?) instead of the config's `variables` and `exclude`.
  void record(const std::vector<std::string>& patterns);
  /// Adds an observer, which must exist until the last step of the run.
  void add(Observer& observer);
  /// Adds an observer of the embedding program. Such an observer may change process-wide state itself, so changes by
  /// FMUs are checked less often.
  void add_foreign(Observer& observer);
  /// Frees the FMUs at the end of the run, so that the report includes errors of freeing. Afterwards variables cannot
  /// be read.
  void free_at_end() { frees_at_end_ = true; }
  /// Unpacks and loads the FMUs without creating instances. Afterwards, the process may be forked, and each child may
  /// start the run. Throws InputError if an FMU cannot be loaded.
  void load();
  /// Starts the run from a state that save_state() returned. The run that saved the state must have the same inputs,
  /// but may belong to another process. Throws InputError if the state does not fit.
  void start_from(std::span<const std::byte> state);

  // The following functions run the simulation.

  /// Opens the FMUs, checks the system, and initialises the run at the start time or at the checkpoint. A second call
  /// has no effect. Throws InputError and Error.
  void start();
  /// Performs one communication step. Starts the run if necessary. Returns false if the run had already ended, or if
  /// an interrupt or an FMU ends it before a new point is reached.
  bool step();
  void run_until(std::int64_t time_ns);
  void run();
  /// Requests the end of the run at the last completed point. Takes effect when the current call to an FMU returns. If
  /// a call to an isolated instance does not return, its process is killed. Safe in signal handlers.
  void interrupt() noexcept { interrupted_.store(true, std::memory_order_relaxed); }
  /// Returns the flag for a SignalGuard.
  std::atomic<bool>& interrupt_flag() { return interrupted_; }
  /// Ends the run at the current point and writes its reports. No effect if the run has already ended. Never throws;
  /// the report contains errors. If a listener calls close(), it acts as interrupt().
  void close() noexcept;
  /// Closes the run and frees its instances. Returns the FMUs that left data in this process which could change the
  /// next run (see LibraryState). Afterwards variables cannot be read.
  std::vector<Leftover> free_instances();
  /// Returns the state between two steps for start_from(). Throws InputError if the run has ended or writes files.
  /// Throws Error if an FMU cannot serialize its state.
  std::vector<std::byte> save_state();
  /// Calls `work`, which may read variables. An observer that was passed to add() must use this function to read
  /// variables.
  void at_point(const std::function<void()>& work);
  /// True if the run started with start_from().
  bool began_later() const { return past_.has_value(); }
  /// True while a function that runs the simulation, saves its state or frees the FMUs is executing, also in the
  /// listeners that it calls.
  bool busy() const { return busy_; }

  // The following functions may be called at any time.

  RunState state() const { return state_; }
  const RunOptions& options() const { return options_; }
  /// Returns the FMUs that are already open, for use in a later run.
  const std::shared_ptr<FmuLibrary>& library() const { return library_; }
  const SystemDescription& system() const { return system_; }
  std::int64_t time_ns() const { return simulation_ ? simulation_->time_ns() : system_.start_time_ns; }
  /// Returns the time of the current communication point [s].
  double time_s() const { return system_.grid().time_s(time_ns()); }
  /// Returns the config's outcome at the last point, or "completed" if no outcome applies. After an interrupt or a
  /// failure, returns "interrupted" or "failed". Empty before the start.
  std::string outcome() const;
  /// Returns the report, which is complete only after the end of the run.
  const RunReport& report() const { return report_; }
  /// Returns the current content of summary.json. Must be called after the start.
  nlohmann::ordered_json summary() const;
  const Statistics& statistics() const { return statistics_; }
  /// Returns the statistics of the solvers for model exchange. Empty if the system has no such solver.
  const std::vector<SolverStatistics>& solvers() const { return solvers_; }
  /// Returns statistics of step control. Null before the start and without step control.
  const StepStatistics* step_statistics() const { return simulation_ ? simulation_->step_statistics() : nullptr; }
  /// Returns the values of the section `summary` in the config. Must be called after the start.
  const SummaryValues& values() const { return *values_; }
  /// Returns the instances whose failure did not end the run.
  std::vector<InstanceLoss> losses() const;
  /// Returns the files of the run; null if the run writes no files.
  const ResultFiles* files() const { return files_ ? &*files_ : nullptr; }
  /// Returns the number of recorded columns without the time.
  std::size_t columns() const { return recorder_ ? recorder_->columns().size() : 0; }

  // The following functions must be called after the start. Before the start and after a failure, they throw
  // InputError.

  const ResolvedSystem& resolved() const;
  /// Calls `work`, which reads or sets variables of an instance. If the FMU fails, the run fails. Listeners may call
  /// this function only at a communication point.
  void call(std::size_t instance, std::string_view what, const std::function<void(Slave&)>& work);
  /// Adds the results of drawn runs (DrawnFlights) to the summary. Must be called after the end of the run.
  void report_uncertainty(const nlohmann::ordered_json& uncertainty);
  /// Sets a variable with write_variable() and stores the value in live_scenario.json. The run must have a results
  /// folder.
  void set_by_hand(std::string_view variable, double value);
  /// Adds the text to the list of written variables in the summary.
  void note_write(const std::string& text);
  /// Returns the rows recorded so far. Throws InputError if the option `in_memory` is not set.
  const MemorySink& memory();

 private:
  Run(Checkpoint checkpoint, const std::filesystem::path& folder);

  void require_open(std::string_view what) const;
  void add_assignments(const std::vector<CheckedSetting>& checked);
  void assign_again();
  void require_alive(std::string_view what) const;
  template <typename Work>
  void attempt(Work work);
  void open();
  void initialise();
  /// Marks the run as busy, so that listeners cannot call functions that step. Also prevents FMUs from cancelling the
  /// calling thread.
  class Busy {
   public:
    Busy(Run& run, std::string_view what);
    ~Busy();
    Busy(const Busy&) = delete;
    Busy& operator=(const Busy&) = delete;

   private:
    Run* run_;
    int cancel_state_ = 0;
  };

  std::vector<std::string> changes() const;
  void begin();
  void advance(std::int64_t until_ns, std::string_view what);
  void note_slaves(Ensemble& ensemble);
  void step_until(std::int64_t until_ns);
  void set_again();
  void write_due();
  std::int64_t next_point_ns() const;
  void finish();
  void fail(ErrorCode code, const std::string& what) noexcept;
  void write_reports() noexcept;
  void write_summary();
  void release_files() noexcept;
  void free_fmus(bool unloads = true);
  void report_fault(const std::string& text);
  void say(Severity severity, std::string_view category, const std::string& text);

  RunOptions options_;
  std::unique_ptr<nlohmann::ordered_json> uncertainty_;
  std::optional<Checkpoint> checkpoint_;  ///< only in a resumed run
  std::optional<SavedRun> past_;          ///< state for start_from()
  RunState state_ = RunState::open;
  bool initialised_ = false;  ///< true after the start time or the checkpoint was reached
  bool busy_ = false;
  bool at_point_ = false;
  bool frees_at_end_ = false;
  bool freed_ = false;
  ExitGuard exit_guard_{busy_, [this](const std::string& what) { fail(ErrorCode::fmu_failed, what); }};
  std::optional<ForkedCopies> copies_;  ///< processes that FMUs forked from this process
  std::atomic<bool> interrupted_{false};
  MessageHub messages_;
  std::vector<Observer*> added_;
  bool has_foreign_ = false;  // true after add_foreign()
  std::shared_ptr<FmuLibrary> library_;
  SystemDescription system_;
  std::vector<std::size_t> parameters_of_config_;  ///< number of parameters of each instance in the config
  std::vector<std::string> setting_changes_;
  std::vector<std::string> scenario_changes_;
  std::vector<std::string> inputs_changes_;
  RunReport report_;
  WriteSaver write_saver_{report_};
  // The following members exist after the start, in the order of their dependencies.
  ResolvedSystem resolved_;
  InputHash hash_;
  Statistics statistics_;
  std::vector<SolverStatistics> solvers_;
  std::vector<InstanceLoss> losses_;
  std::optional<Scenario> scenario_;
  std::optional<ResultFiles> files_;
  std::optional<LiveScenario> live_scenario_;  // only with a results folder
  std::optional<ProcessUse> process_use_;
  std::optional<Simulation> simulation_;
  std::optional<Recorder> recorder_;
  MemorySink* memory_ = nullptr;  // owned by the recorder; null without `in_memory`
  std::optional<SummaryValues> values_;
  std::optional<Outcomes> outcomes_;
  std::optional<StopConditions> stop_conditions_;
  std::optional<Coupling> coupling_;  // only if the config requests it
};

/// Returns the variable "instance.variable" of a started run. If it does not exist, throws InputError with the nearest
/// names.
ResolvedVariable find_variable(const Run& run, std::string_view name);

/// Sets an unconnected input or a tunable parameter between two steps. summary.json lists the value under
/// `inputs.writes`. `place` names the caller in errors. Returns the value in the variable's type. Throws InputError if
/// the variable cannot be set or does not accept the value.
nlohmann::ordered_json write_variable(Run& run, std::string_view name, double value, const std::string& place);

/// Returns the variables that write_variable() accepts as a list of {"variable", "unit", "text", "type"}.
nlohmann::ordered_json writable_variables(const ResolvedSystem& system);

}  // namespace mebots::master
