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

/// A run of a system, from the options to the report. The command line, C++ and Python use this class.
///
/// RunState is the state of a run. If start(), step() or a similar function fails, it sets the state to `failed` and
/// throws. The files contain the results so far. A failed run calls no FMU, and its step() throws.
///
/// At each communication point, observers are called in this order: scenario, files of the start, pictures, recorder,
/// values of the summary, outcomes, stop conditions, coupling, those of add(), checkpoint. Thus a checkpoint at a point
/// contains the data of all other observers for this point.
///
/// For one thread at a time; interrupt() may be called from any thread and from signal handlers.
class Run {
 public:
  /// Reads the config and applies the options. Creates no files. Throws InputError. If an earlier run used `library`,
  /// FMUs that the earlier run opened are not opened again.
  explicit Run(const std::filesystem::path& config, RunOptions options = {},
               std::shared_ptr<FmuLibrary> library = std::make_shared<FmuLibrary>());
  /// Returns the run of the checkpoint in this folder; start() restores its state. Throws InputError.
  static std::unique_ptr<Run> resume(const std::filesystem::path& folder, bool in_memory = false);
  /// Closes the run.
  ~Run();
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  // Functions to call before start().

  /// Adds a listener for messages of FMUs and notices of the run.
  void listen(MessageHub::Listener listener);
  /// Replaces a parameter or start value of the config, or all that match a pattern (* and ?). Opens the FMUs and
  /// checks name, type and limits. If other settings can change the size of an array, start() checks whether the array
  /// has the element. If the setting changes a size, earlier patterns match the new elements, too.
  void set(const Setting& written);
  /// Appends the overrides of a scenario file.
  void add_scenario(const std::filesystem::path& file);
  /// Uses a CSV file's columns as sources of the unconnected inputs with the same names.
  void add_inputs(const std::filesystem::path& file);
  void set_stop_time(std::int64_t stop_time_ns, const std::string& place);
  /// Records these variables (patterns with * and ?) in place of the config's `variables` and `exclude`.
  void record(const std::vector<std::string>& patterns);
  /// Adds an observer, which must outlive the run's last step.
  void add(Observer& observer);
  /// Adds an observer of the embedding program, which may change the process itself. With such an observer,
  /// process-wide changes by FMUs are checked less often.
  void add_foreign(Observer& observer);
  /// Requests that the FMUs are freed at the end of the run, so that errors of freeing appear in the report. Variables
  /// cannot be read after the end.
  void free_at_end() { frees_at_end_ = true; }
  /// Unpacks and loads the FMUs and creates no instance. A process that is forked after this call starts the run as a
  /// new process would. Throws InputError.
  void load();
  /// Starts the run from a state that save_state() returned for a run with the same inputs, in this process or another.
  /// Throws InputError.
  void start_from(std::span<const std::byte> state);

  // Functions that run the simulation.

  /// Opens the FMUs, checks the system, and initialises the run at t = 0 or at the checkpoint. A second call has no
  /// effect. Throws InputError and Error.
  void start();
  /// Takes one communication step. Starts the run if necessary. Returns false if the run had already ended. Also
  /// returns false if the run ends in this step without reaching a new point, because of an interrupt or an FMU.
  bool step();
  /// Steps until `time_ns` or the end of the run, whichever is earlier.
  void run_until(std::int64_t time_ns);
  /// Runs to the end.
  void run();
  /// Requests the end of the run at the last point that all instances reached. Takes effect when the present call to an
  /// FMU returns. If a call to an isolated instance does not return, its process is ended. Safe in signal handlers.
  void interrupt() noexcept { interrupted_.store(true, std::memory_order_relaxed); }
  /// Returns the flag for a SignalGuard.
  std::atomic<bool>& interrupt_flag() { return interrupted_; }
  /// Ends the run at the present point and writes its reports. Has no effect if the run has ended. Never throws; the
  /// report contains errors. A call from a listener acts as interrupt().
  void close() noexcept;
  /// Closes the run and frees its instances. Returns the FMUs that are not clean (see LibraryState), because they left
  /// data in this process that could change the next run. Variables cannot be read afterwards.
  std::vector<Leftover> free_instances();
  /// Returns the state between two steps, for start_from(). Throws InputError if the run has ended or writes files, and
  /// Error if an FMU cannot serialize its state.
  std::vector<std::byte> save_state();
  /// Calls `work`, in which variables may be read. Observers that were added with add() use this function.
  void at_point(const std::function<void()>& work);
  /// True if the run started with start_from() instead of at t = 0.
  bool began_later() const { return past_.has_value(); }
  /// True during a call that steps, therefore also in listeners.
  bool busy() const { return busy_; }

  // Functions to call at any time.

  RunState state() const { return state_; }
  const RunOptions& options() const { return options_; }
  /// Returns the FMUs opened so far, for a later run.
  const std::shared_ptr<FmuLibrary>& library() const { return library_; }
  const SystemDescription& system() const { return system_; }
  std::int64_t time_ns() const { return simulation_ ? simulation_->time_ns() : system_.start_time_ns; }
  /// Returns the double nearest to the time of the communication point.
  double time_s() const { return system_.grid().time_s(time_ns()); }
  /// Returns the config's outcome at the last point ("completed" if none applies), or "interrupted" or "failed". Empty
  /// before the start.
  std::string outcome() const;
  /// Returns the report. It is complete only after the end of the run.
  const RunReport& report() const { return report_; }
  /// Returns the content of summary.json so far. Must be called after the start.
  nlohmann::ordered_json summary() const;
  const Statistics& statistics() const { return statistics_; }
  /// Returns the statistics of the solvers of model exchange; empty if there are none.
  const std::vector<SolverStatistics>& solvers() const { return solvers_; }
  /// Returns counts of the communication steps under step control; null without step control, and before the start.
  const StepStatistics* step_statistics() const { return simulation_ ? simulation_->step_statistics() : nullptr; }
  /// Returns the values that the config requests under `summary`. Must be called after the start.
  const SummaryValues& values() const { return *values_; }
  /// Returns the instances that failed without ending the run.
  std::vector<InstanceLoss> losses() const;
  /// Returns the files of the run; null if the run writes no files.
  const ResultFiles* files() const { return files_ ? &*files_ : nullptr; }
  /// Returns the number of recorded columns, without the time.
  std::size_t columns() const { return recorder_ ? recorder_->columns().size() : 0; }

  // Functions to call after the start. Before the start and after a failure, they throw InputError.

  const ResolvedSystem& resolved() const;
  /// Calls `work`, which reads or sets variables of an instance. If the FMU fails, the run fails. A listener may call
  /// this function only at a communication point.
  void call(std::size_t instance, std::string_view what, const std::function<void(Slave&)>& work);
  /// Adds the intervals of drawn runs (DrawnFlights) to the summary, after the end of the run.
  void report_uncertainty(const nlohmann::ordered_json& uncertainty);
  /// Sets a variable as write_variable() does, and stores the value in live_scenario.json. The run must have a folder.
  void set_by_hand(std::string_view variable, double value);
  /// Adds the text to the summary's list of written variables.
  void note_write(const std::string& text);
  /// Returns the recorded rows so far. Throws InputError if the option `in_memory` is not set.
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
  /// While this object exists, a listener cannot call functions of the run that step. FMUs cannot cancel the calling
  /// thread.
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
  std::optional<Checkpoint> checkpoint_;  ///< to resume from
  std::optional<SavedRun> past_;          ///< to start from, of another run
  RunState state_ = RunState::open;
  bool initialised_ = false;  ///< reached t = 0 or the checkpoint
  bool busy_ = false;
  bool at_point_ = false;
  bool frees_at_end_ = false;
  bool freed_ = false;
  ExitGuard exit_guard_{busy_, [this](const std::string& what) { fail(ErrorCode::fmu_failed, what); }};
  std::optional<ForkedCopies> copies_;  ///< forked by FMUs in this process
  std::atomic<bool> interrupted_{false};
  MessageHub messages_;
  std::vector<Observer*> added_;
  bool has_foreign_ = false;  // has observers of the embedding program
  std::shared_ptr<FmuLibrary> library_;
  SystemDescription system_;
  std::vector<std::size_t> parameters_of_config_;  ///< numbers of each instance's parameters in the config
  std::vector<std::string> setting_changes_;
  std::vector<std::string> scenario_changes_;
  std::vector<std::string> inputs_changes_;
  RunReport report_;
  WriteSaver write_saver_{report_};
  // Members that exist after the start, in the order of their dependencies.
  ResolvedSystem resolved_;
  InputHash hash_;
  Statistics statistics_;
  std::vector<SolverStatistics> solvers_;
  std::vector<InstanceLoss> losses_;
  std::optional<Scenario> scenario_;
  std::optional<ResultFiles> files_;
  std::optional<LiveScenario> live_scenario_;  // if there are files
  std::optional<ProcessUse> process_use_;
  std::optional<Simulation> simulation_;
  std::optional<Recorder> recorder_;
  MemorySink* memory_ = nullptr;  // the recorder's; null if there is none
  std::optional<SummaryValues> values_;
  std::optional<Outcomes> outcomes_;
  std::optional<StopConditions> stop_conditions_;
  std::optional<Coupling> coupling_;  // if the config requests it
};

/// Finds "instance.variable" in a started run. If it does not exist, throws InputError with the nearest names.
ResolvedVariable find_variable(const Run& run, std::string_view name);

/// Sets an unconnected input or a tunable parameter from the next step on, between two steps. summary.json lists it
/// under `inputs.writes`. `place` names the caller in errors. Returns the value in the variable's type. Throws
/// InputError if the variable cannot be set or does not accept the value.
nlohmann::ordered_json write_variable(Run& run, std::string_view name, double value, const std::string& place);

/// Returns the variables that write_variable() accepts: [{"variable", "unit", "text", "type"}], in the order of
/// instances and descriptions.
nlohmann::ordered_json writable_variables(const ResolvedSystem& system);

}  // namespace mebots::master
