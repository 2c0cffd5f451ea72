// SPDX-License-Identifier: Apache-2.0
#include "run_command.hpp"

#include "interrupt.hpp"

#include "base/time.hpp"
#include "config/command_line.hpp"
#include "message/console.hpp"
#include "observer/conditions.hpp"
#include "observer/parameter_recorder.hpp"
#include "observer/picture_recorder.hpp"
#include "observer/progress.hpp"
#include "observer/recorder.hpp"
#include "observer/scenario.hpp"
#include "run/result_folder.hpp"
#include "run/simulation.hpp"
#include "run/summary.hpp"
#include "sink/csv_rows.hpp"
#include "sink/csv_sink.hpp"
#include "sink/hdf5_sink.hpp"
#include "system/record_choice.hpp"

#include <fmt/format.h>

#include <charconv>
#include <chrono>
#include <functional>
#include <list>

namespace mebots::app {
namespace {

using namespace mebots::master;

constexpr int kRanToItsEnd = 0;
constexpr int kFailed = 1;
constexpr int kBadInput = 2;

double timed(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::string_view name_of(EndReason reason) {
  switch (reason) {
    case EndReason::stop_time:
      return "stop_time";
    case EndReason::stop_condition:
      return "stop_condition";
    case EndReason::terminated:
      return "terminated";
    case EndReason::interrupted:
      break;
  }
  return "interrupted";
}

/// Puts this run's files in the place of an earlier run's, once it has come to t = 0.
class KeepResults final : public Observer {
 public:
  explicit KeepResults(ResultFolder& folder) : folder_(&folder) {}

  std::optional<std::string> reached(const Point& point) override {
    if (point.step == 0)
      folder_->keep({"summary.json", "results.csv", "results.h5", "parameters.csv", kCheckpointFile});
    return std::nullopt;
  }

 private:
  ResultFolder* folder_;
};

/// An SSP may lack both; a config has its own and is checked against the options later.
GivenTimes given_times(const RunOptions& options) {
  GivenTimes times;
  times.step_s = options.step_s;
  if (options.config.extension() == ".ssp" && options.stop_time_s) {
    const auto& text = *options.stop_time_s;
    double stop_time_s = 0;  // what is no number is refused by apply_stop_time
    if (std::from_chars(text.data(), text.data() + text.size(), stop_time_s).ec == std::errc{}) {
      times.stop_time_s = stop_time_s;
    }
  }
  return times;
}

/// One run from config to summary.
class Run {
 public:
  explicit Run(const RunOptions& options)
      : options_(options), console_(options.quiet), interrupted_(catch_interrupts()) {}

  int execute() {
    try {
      report_.wall.open_s = timed([&] { open(); });
    } catch (const InputError& error) {
      console_.error(error.what());
      return kBadInput;
    }
    int code = kRanToItsEnd;
    try {
      report_.wall.initialise_s = timed([&] { initialise(); });
      step();
      if (report_.outcome == "interrupted") code = kFailed;
    } catch (const InputError& error) {
      code = fail(error.what(), kBadInput);
    } catch (const Error& error) {
      code = fail(error.what(), kFailed);
    } catch (const std::exception& error) {  // out of memory, say: the results so far are kept all the same
      code = fail(error.what(), kFailed);
    }
    if (folder_->kept()) return finish(code);
    console_.set_log_file(nullptr);  // t = 0 was never reached: the folder stays as it was found
    return code;
  }

 private:
  void open() {
    system_ = load_system(options_.config, given_times(options_)).system;
    if (options_.step_s) report_.overrides.push_back(fmt::format("--step {}", *options_.step_s));
    for (const auto& set : options_.sets) {
      apply_set(system_, set);
      report_.overrides.push_back("--set " + set);
    }
    for (const auto& file : options_.scenarios) report_.overrides.push_back(apply_scenario(system_, file));
    if (options_.stop_time_s) {
      apply_stop_time(system_, *options_.stop_time_s);
      report_.overrides.push_back("--stop-time " + *options_.stop_time_s);
    }
    if (options_.isolate) {
      for (auto& instance : system_.instances) instance.isolation.own_process = true;
    }
    const auto every_ns = checkpoint_interval_ns();
    resolved_ = resolve(system_, library_);
    report_.notices = resolved_.notices;
    hash_ = hash_inputs(system_, report_.overrides);
    if (every_ns > 0) check_can_checkpoint(resolved_);
    if (every_ns > 0 && !system_.record.csv) {
      throw InputError(
          "--checkpoint-every: checkpoints count on results.csv; let \"format\" under \"record\" be \"both\"");
    }
    if (options_.checkpoint) check_inputs(*options_.checkpoint, hash_.lines);
    recorded_variables(resolved_);  // a name that fits nothing is bad input: say so before any file is made
    recorded_parameters(resolved_);
    for (const auto& pictures : system_.pictures) check_pictures(resolved_, pictures);
    scenario_.emplace(resolved_);

    folder_.emplace(options_.out.empty() ? std::filesystem::path("results") / system_.name : options_.out);
    if (options_.checkpoint) {
      reopen_files();
      return;
    }
    if (system_.record.csv) results_file_ = &folder_->create("results.csv");
    log_file_ = &folder_->create("log.txt");
    console_.set_log_file(log_file_);
    for (const auto& notice : resolved_.notices) console_.line("notice: " + notice);
  }

  /// What `--checkpoint-every` asks for; 0 = none.
  std::int64_t checkpoint_interval_ns() const {
    if (options_.checkpoint) return options_.checkpoint->request.checkpoint_every_ns;
    if (!options_.checkpoint_every_s) return 0;
    return read_duration("--checkpoint-every", *options_.checkpoint_every_s);
  }

  /// The files of the run that is resumed; what came after its checkpoint is cut off later.
  void reopen_files() {
    results_file_ = &folder_->reopen("results.csv");
    log_file_ = &folder_->reopen("log.txt");
    if (results_file_->size() < options_.checkpoint->results_bytes ||
        log_file_->size() < options_.checkpoint->log_bytes) {
      throw InputError(
          fmt::format("{}: results.csv or log.txt is shorter than it was at the checkpoint; run the config "
                      "anew",
                      folder_->path().string()));
    }
    console_.line(fmt::format("resuming at {} s", to_seconds(options_.checkpoint->time_ns)));
  }

  void initialise() {
    SlaveOptions slaves;
    slaves.statistics = options_.statistics ? &statistics_ : nullptr;
    slaves.losses = &losses_;
    slaves.scenario = &*scenario_;
    slaves.interrupted = &interrupted_;
    simulation_.emplace(resolved_, console_, slaves);
    auto& ensemble = simulation_->ensemble();
    scenario_->watch(resolved_, ensemble);
    recorder_.emplace(resolved_, ensemble);
    add_sinks();
    keep_results_.emplace(*folder_);
    simulation_->add(*keep_results_);
    if (!system_.record.parameters.empty()) {
      parameters_.emplace(resolved_, ensemble, folder_->path() / "parameters.csv");
      simulation_->add(*parameters_);
    }
    for (const auto& pictures : system_.pictures) {
      simulation_->add(picture_recorders_.emplace_back(resolved_, ensemble, pictures,
                                                       folder_->path() / "pictures" / pictures.frame.text()));
    }
    values_.emplace(resolved_, ensemble);
    outcomes_.emplace(resolved_, ensemble);
    stop_conditions_.emplace(resolved_, ensemble);
    progress_.emplace(console_, system_.stop_time_ns);
    for (Observer* observer : std::initializer_list<Observer*>{&*scenario_, &*recorder_, &*values_, &*outcomes_,
                                                               &*stop_conditions_, &*progress_}) {
      simulation_->add(*observer);
    }
    if (const auto every_ns = checkpoint_interval_ns(); every_ns > 0) {
      checkpointer_.emplace(*simulation_, folder_->path(), blank_checkpoint(every_ns), *results_file_, *log_file_);
      simulation_->add(*checkpointer_);
    }
    if (options_.checkpoint) {
      simulation_->resume(options_.checkpoint->simulation);
      log_file_->truncate(options_.checkpoint->log_bytes);
      console_.set_log_file(log_file_);
      folder_->keep({});
    } else {
      simulation_->initialize();
    }
    put_hdf5_parameters();
  }

  void add_sinks() {
    const auto& columns = recorder_->columns();
    if (system_.record.csv) recorder_->add(std::make_unique<CsvSink>(columns, *results_file_));
    if (!system_.record.hdf5) return;
    auto sink = std::make_unique<Hdf5Sink>(columns, folder_->reserve("results.h5"));
    hdf5_ = sink.get();
    // A file that was being written when its process was killed may be broken: its rows are in results.csv too.
    if (options_.checkpoint) {
      copy_csv_rows(results_file_->path(), options_.checkpoint->results_bytes, columns, *sink);
    }
    recorder_->add(std::move(sink));
  }

  /// Parameters of the initialised instances, into HDF5 as well.
  void put_hdf5_parameters() {
    if (hdf5_ != nullptr && !system_.record.parameters.empty()) {
      hdf5_->put_parameters(read_parameters(resolved_, simulation_->ensemble()));
    }
  }

  Checkpoint blank_checkpoint(std::int64_t every_ns) const {
    Checkpoint checkpoint;
    auto& request = checkpoint.request;
    request.config = std::filesystem::absolute(options_.config).string();
    request.sets = options_.sets;
    for (const auto& file : options_.scenarios) request.scenarios.push_back(std::filesystem::absolute(file).string());
    request.stop_time = options_.stop_time_s.value_or("");
    request.isolate = options_.isolate;
    request.checkpoint_every_ns = every_ns;
    checkpoint.inputs = hash_.lines;
    return checkpoint;
  }

  void step() {
    // Counted even when a step fails.
    const auto start = std::chrono::steady_clock::now();
    const auto count_time = [&] {
      report_.wall.stepping_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    try {
      simulation_->run(interrupted_);
      count_time();
    } catch (...) {
      count_time();
      throw;
    }
    const auto& end = simulation_->end();
    report_.end_reason = name_of(end.reason);
    report_.end_text = end.text;
    report_.outcome = end.reason == EndReason::interrupted ? "interrupted" : outcomes_->outcome();
    try {
      simulation_->terminate();
    } catch (const SlaveError& error) {
      report_.notices.push_back(fmt::format("after the end: {}", error.what()));
      console_.warning(report_.notices.back());
    }
  }

  int fail(const std::string& what, int code) {
    console_.redraw("");
    console_.error(what);
    report_.outcome = report_.end_reason = "failed";
    report_.end_text = "the simulation failed";
    report_.error = what;
    return code;
  }

  /// Closes the files and writes the summary, whatever happened before.
  int finish(int code) {
    report_.simulated_ns = simulation_->time_ns();
    report_.steps = simulation_->steps_done();
    report_.rows = recorder_->rows();
    console_.set_log_file(nullptr);
    const std::initializer_list<std::function<void()>> endings = {[&] { recorder_->flush(); },
                                                                  [&] {
                                                                    if (results_file_ != nullptr)
                                                                      results_file_->close();
                                                                  },
                                                                  [&] { log_file_->close(); }};
    for (const auto& ending : endings) {
      try {
        ending();
      } catch (const Error& error) {
        if (report_.error.empty()) fail(error.what(), kFailed);
        if (code == kRanToItsEnd) code = kFailed;
      }
    }
    auto json = summary_json(resolved_, hash_, report_, *values_);
    if (!system_.scenario.empty()) json["scenario"] = scenario_->report(resolved_, report_.simulated_ns);
    for (const auto& loss : losses_) {
      if (loss.at_ns < 0) continue;
      json["lost_instances"][loss.name] = {{"at", to_seconds(loss.at_ns)}, {"error", loss.text}};
      console_.warning(
          fmt::format("'{}' was lost at {} s; the others went on without it", loss.name, to_seconds(loss.at_ns)));
    }
    if (options_.statistics) json["statistics"] = statistics_json(statistics_, simulating_s());
    try {
      OutputFile file(folder_->path() / "summary.json.new");
      file.append(json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
      file.close();
      file.rename(folder_->path() / "summary.json");  // whole or not at all
    } catch (const Error& error) {
      std::error_code ignored;
      std::filesystem::remove(folder_->path() / "summary.json.new", ignored);
      console_.error(error.what());
      if (code == kRanToItsEnd) code = kFailed;
    }
    if (code == kRanToItsEnd) {  // there is nothing to go on with
      std::error_code ignored;
      std::filesystem::remove(folder_->path() / kCheckpointFile, ignored);
    }
    if (report_.error.empty()) show_end(json);
    if (options_.statistics) {
      for (const auto& line : statistics_table(statistics_, simulating_s())) console_.line(line);
    }
    return code;
  }

  /// Wall time in which instances are called [s].
  double simulating_s() const { return report_.wall.initialise_s + report_.wall.stepping_s; }

  void show_end(const nlohmann::ordered_json& json) {
    console_.line(fmt::format("outcome: {} ({})", report_.outcome, report_.end_text));
    console_.line(fmt::format("simulated {} s in {} of stepping, {:.3g} x real time", to_seconds(report_.simulated_ns),
                              short_duration(report_.wall.stepping_s), report_.real_time_factor()));
    show_values(values_->values(), json.at("units"), "");
    const char* name = system_.record.csv ? "results.csv" : "results.h5";
    console_.line(fmt::format("results: {} ({} rows, {} columns), {}", (folder_->path() / name).string(), report_.rows,
                              recorder_->columns().size(), (folder_->path() / "summary.json").string()));
  }

  static std::string short_duration(double seconds) {
    return seconds < 1 ? fmt::format("{:.3g} ms", seconds * 1e3) : fmt::format("{:.3g} s", seconds);
  }

  void show_values(const nlohmann::ordered_json& values, const nlohmann::ordered_json& units,
                   const std::string& prefix) {
    for (const auto& [label, value] : values.items()) {
      const auto unit = units.is_object() && units.contains(label) ? units.at(label) : nlohmann::ordered_json();
      if (value.is_object()) {
        show_values(value, unit, prefix + label + ".");
        continue;
      }
      const auto text = value.is_string()         ? value.get<std::string>()
                        : value.is_number_float() ? fmt::format("{:.6g}", value.get<double>())
                                                  : value.dump();
      const bool shown_unit = unit.is_string() && unit != "1";
      console_.line(
          fmt::format("  {:<24} {}{}", prefix + label, text, shown_unit ? " " + unit.get<std::string>() : ""));
    }
  }

  const RunOptions& options_;
  Console console_;
  const std::atomic<bool>& interrupted_;
  FmuLibrary library_;
  SystemDescription system_;
  ResolvedSystem resolved_;
  InputHash hash_;
  RunReport report_;
  Statistics statistics_;
  std::vector<InstanceLoss> losses_;
  std::optional<Scenario> scenario_;
  std::optional<ResultFolder> folder_;
  OutputFile* results_file_ = nullptr;
  OutputFile* log_file_ = nullptr;
  std::optional<Simulation> simulation_;
  std::optional<KeepResults> keep_results_;
  std::optional<ParameterRecorder> parameters_;
  std::optional<Recorder> recorder_;
  Hdf5Sink* hdf5_ = nullptr;  // of the recorder; null without one
  std::optional<Checkpointer> checkpointer_;
  std::list<PictureRecorder> picture_recorders_;  // the simulation holds on to their addresses
  std::optional<SummaryValues> values_;
  std::optional<Outcomes> outcomes_;
  std::optional<StopConditions> stop_conditions_;
  std::optional<Progress> progress_;
};

}  // namespace

int run_command(const RunOptions& options) {
  return Run(options).execute();
}

}  // namespace mebots::app
