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
#include "run/result_files.hpp"
#include "run/simulation.hpp"
#include "run/summary.hpp"

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

/// One run, from the request to the report. The command line, C++ and Python all use it.
///
/// RunState says where it stands. An error in start(), step() and the like makes the run `failed` and is thrown; the
/// files hold what was reached until then. After that the FMUs are not called any more: step() throws.
///
/// Observers hear of each communication point in this order: scenario, files of the start, pictures, recorder, values
/// of the summary, outcomes, stop conditions, coupling, those of add(), checkpoint. So a checkpoint holds what all
/// others made of its point.
///
/// One thread at a time; interrupt() from any thread and from signal handlers.
class Run {
 public:
  /// Reads the config and applies the options to it. Throws InputError; no file is made. With the library of an earlier
  /// run, FMUs that it has opened are not opened again.
  explicit Run(const std::filesystem::path& config, RunOptions options = {},
               std::shared_ptr<FmuLibrary> library = std::make_shared<FmuLibrary>());
  /// The run whose checkpoint is in this folder, as it stood there, once it is started. Throws InputError.
  static std::unique_ptr<Run> resume(const std::filesystem::path& folder, bool in_memory = false);
  /// Closes the run.
  ~Run();
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  // While it is open.

  /// Who hears messages of FMUs and notices of the run.
  void listen(MessageHub::Listener listener);
  /// A parameter or start value, in place of the config's. Opens the instance's FMU and checks name, type and limits.
  void set(const Setting& written);
  /// Appends the overrides of a file.
  void add_scenario(const std::filesystem::path& file);
  /// Takes a CSV file's columns as sources of the free inputs that they are named after.
  void add_inputs(const std::filesystem::path& file);
  void set_stop_time(std::int64_t stop_time_ns, const std::string& place);
  /// Records these variables (patterns with * and ?) in place of the config's `variables` and `exclude`.
  void record(const std::vector<std::string>& patterns);
  /// Must outlive the run's last step.
  void add(Observer& observer);
  /// One of the program around, which may change the process as it likes: what the FMUs change in their steps is looked
  /// for less often then.
  void add_foreign(Observer& observer);
  /// Variables are not read after the end: the FMUs are freed then, and what goes wrong in that stands in the report.
  void free_at_end() { frees_at_end_ = true; }
  /// Unpacks and loads the FMUs, and makes no instance: a fork of the process from here on begins as a fresh one.
  /// Throws InputError.
  void load();
  /// Begins where save_state() of a run of the same inputs was called, in this process or another. Throws InputError.
  void start_from(std::span<const std::byte> state);

  // On the way.

  /// Opens the FMUs, checks everything that can be checked, and goes to t = 0 or to the checkpoint. Nothing, when that
  /// was done. Throws InputError and Error.
  void start();
  /// One communication step. False when the end was reached before, or in this step without a new point (an FMU that
  /// ended the run, an interrupt). Starts the run if need be.
  bool step();
  /// Steps until `time_ns`, or to the end if that comes first.
  void run_until(std::int64_t time_ns);
  /// To the end.
  void run();
  /// Asks for the end at the last point that all instances reached: within the next call to an FMU that returns. A
  /// call to an isolated instance is ended. Safe in signal handlers.
  void interrupt() noexcept { interrupted_.store(true, std::memory_order_relaxed); }
  /// For a SignalGuard.
  std::atomic<bool>& interrupt_flag() { return interrupted_; }
  /// Ends the run at the current point, and writes its reports. No effect after the end. Never throws; the report
  /// contains errors. From a listener: as interrupt().
  void close() noexcept;
  /// Closes the run and frees its instances. Lists the FMUs that are not clean: the next run in this process might find
  /// what they left. No variable can be read from then on.
  std::vector<Leftover> free_instances();
  /// The run as it stands between two steps, for start_from(). Throws InputError for one that has ended or writes
  /// files, and Error where an FMU cannot write its state as bytes.
  std::vector<std::byte> save_state();
  /// For observers of add(): variables may be read in `work`.
  void at_point(const std::function<void()>& work);
  /// True if it began with start_from() in place of t = 0.
  bool began_later() const { return past_.has_value(); }
  /// True in a call that steps, so also for the listeners that it calls.
  bool busy() const { return busy_; }

  // At any time.

  RunState state() const { return state_; }
  const RunOptions& options() const { return options_; }
  /// The FMUs that were opened so far, for a run after this one.
  const std::shared_ptr<FmuLibrary>& library() const { return library_; }
  const SystemDescription& system() const { return system_; }
  std::int64_t time_ns() const { return simulation_ ? simulation_->time_ns() : system_.start_time_ns; }
  /// The double nearest to the communication point.
  double time_s() const { return system_.grid().time_s(time_ns()); }
  /// The config's outcome at the point reached last ("completed" when none fits); "interrupted" and "failed" where the
  /// run was. Empty before the start.
  std::string outcome() const;
  /// What is known so far; complete once the run is over.
  const RunReport& report() const { return report_; }
  /// The content of summary.json, as far as it is known. From the start on.
  nlohmann::ordered_json summary() const;
  const Statistics& statistics() const { return statistics_; }
  /// The work of the solvers of model exchange; empty without one.
  const std::vector<SolverStatistics>& solvers() const { return solvers_; }
  /// The communication steps under step control; null without it. From the start on.
  const StepStatistics* step_statistics() const { return simulation_ ? simulation_->step_statistics() : nullptr; }
  /// The values that the config asks for under `summary`. From the start on.
  const SummaryValues& values() const { return *values_; }
  /// Instances that failed while the others went on.
  std::vector<InstanceLoss> losses() const;
  /// Null without files.
  const ResultFiles* files() const { return files_ ? &*files_ : nullptr; }
  /// How many columns a row has, the time left out.
  std::size_t columns() const { return recorder_ ? recorder_->columns().size() : 0; }

  // From the start on. These throw InputError before, and after a failure.

  const ResolvedSystem& resolved() const;
  /// Reads or sets variables of an instance. An error of the FMU fails the run. From a listener: at a point only.
  void call(std::size_t instance, std::string_view what, const std::function<void(Slave&)>& work);
  /// Adds the intervals of drawn flights to the summary of a run that has ended.
  void report_uncertainty(const nlohmann::ordered_json& uncertainty);
  /// What was set on the way, for the summary.
  void note_write(const std::string& text);
  /// Rows so far. Throws InputError without the option `in_memory`.
  const MemorySink& memory();

 private:
  Run(Checkpoint checkpoint, const std::filesystem::path& folder);

  void require_open(std::string_view what) const;
  std::shared_ptr<const modeldesc::ModelDescription> model_of(const InstanceDescription& instance) const;
  void require_alive(std::string_view what) const;
  template <typename Work>
  void attempt(Work work);
  void open();
  void initialise();
  /// Keeps listeners from calling back into what called them, and FMUs from cancelling the thread that calls them.
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
  std::optional<Checkpoint> checkpoint_;  ///< to go on from
  std::optional<SavedRun> past_;          ///< the same, of another run
  RunState state_ = RunState::open;
  bool initialised_ = false;  ///< came to t = 0, or to the checkpoint
  bool busy_ = false;
  bool at_point_ = false;
  bool frees_at_end_ = false;
  bool freed_ = false;
  ExitGuard exit_guard_{busy_, [this](const std::string& what) { fail(ErrorCode::fmu_failed, what); }};
  std::optional<ForkedCopies> copies_;  ///< that FMUs in this process forked
  std::atomic<bool> interrupted_{false};
  MessageHub messages_;
  std::vector<Observer*> added_;
  bool has_foreign_ = false;  // observers of the program around
  std::shared_ptr<FmuLibrary> library_;
  SystemDescription system_;
  std::vector<std::string> setting_changes_;
  std::vector<std::string> scenario_changes_;
  std::vector<std::string> inputs_changes_;
  RunReport report_;
  // From the start on, in the order in which they depend on each other.
  ResolvedSystem resolved_;
  InputHash hash_;
  Statistics statistics_;
  std::vector<SolverStatistics> solvers_;
  std::vector<InstanceLoss> losses_;
  std::optional<Scenario> scenario_;
  std::optional<ResultFiles> files_;
  std::optional<ProcessUse> process_use_;
  std::optional<Simulation> simulation_;
  std::optional<Recorder> recorder_;
  MemorySink* memory_ = nullptr;  // of the recorder; null without one
  std::optional<SummaryValues> values_;
  std::optional<Outcomes> outcomes_;
  std::optional<StopConditions> stop_conditions_;
  std::optional<Coupling> coupling_;  // where the config asks for it
};

/// Finds "instance.variable" in a started run. Throws InputError with the nearest names.
ResolvedVariable find_variable(const Run& run, std::string_view name);

/// Sets an unconnected input or a tunable parameter from the next step on, between two steps. summary.json lists it
/// under `inputs.writes`. `place` names the caller in errors. Returns the value in the variable's type. Throws
/// InputError if the variable cannot be set or does not accept the value.
modeldesc::Value write_variable(Run& run, std::string_view name, double value, const std::string& place);

/// What write_variable() takes: [{"variable", "unit", "text", "type"}], in the order of instances and descriptions.
nlohmann::ordered_json writable_variables(const ResolvedSystem& system);

}  // namespace mebots::master
