// SPDX-License-Identifier: Apache-2.0
#include "run_command.hpp"

#include "interrupt.hpp"

#include "mebots/master/command_line.hpp"
#include "mebots/master/conditions.hpp"
#include "mebots/master/console.hpp"
#include "mebots/master/csv_sink.hpp"
#include "mebots/master/parameter_recorder.hpp"
#include "mebots/master/picture_recorder.hpp"
#include "mebots/master/progress.hpp"
#include "mebots/master/record_choice.hpp"
#include "mebots/master/recorder.hpp"
#include "mebots/master/result_folder.hpp"
#include "mebots/master/simulation.hpp"
#include "mebots/master/summary.hpp"
#include "mebots/master/time.hpp"

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
    if (point.step == 0) folder_->keep({"summary.json", "parameters.csv"});
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
    if (options_.stop_time_s) {
      apply_stop_time(system_, *options_.stop_time_s);
      report_.overrides.push_back("--stop-time " + *options_.stop_time_s);
    }
    resolved_ = resolve(system_, library_);
    report_.notices = resolved_.notices;
    hash_ = hash_inputs(system_, report_.overrides);
    recorded_variables(resolved_);  // a name that fits nothing is bad input: say so before any file is made
    recorded_parameters(resolved_);
    for (const auto& pictures : system_.pictures) check_pictures(resolved_, pictures);

    folder_.emplace(options_.out.empty() ? std::filesystem::path("results") / system_.name : options_.out);
    results_file_ = &folder_->create("results.csv");
    log_file_ = &folder_->create("log.txt");
    console_.set_log_file(log_file_);
    for (const auto& notice : resolved_.notices) console_.line("notice: " + notice);
  }

  void initialise() {
    const SlaveOptions slaves{options_.statistics ? &statistics_ : nullptr};
    simulation_.emplace(resolved_, console_, slaves);
    auto& ensemble = simulation_->ensemble();
    recorder_.emplace(resolved_, ensemble);
    recorder_->add(std::make_unique<CsvSink>(recorder_->columns(), *results_file_));
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
    for (Observer* observer :
         std::initializer_list<Observer*>{&*recorder_, &*values_, &*outcomes_, &*stop_conditions_, &*progress_}) {
      simulation_->add(*observer);
    }
    simulation_->initialize();
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
    const std::initializer_list<std::function<void()>> endings = {
        [&] { recorder_->flush(); }, [&] { results_file_->close(); }, [&] { log_file_->close(); }};
    for (const auto& ending : endings) {
      try {
        ending();
      } catch (const Error& error) {
        if (report_.error.empty()) fail(error.what(), kFailed);
        if (code == kRanToItsEnd) code = kFailed;
      }
    }
    auto json = summary_json(resolved_, hash_, report_, *values_);
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
    console_.line(fmt::format("results: {} ({} rows, {} columns), {}", results_file_->path().string(), report_.rows,
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
  std::optional<ResultFolder> folder_;
  OutputFile* results_file_ = nullptr;
  OutputFile* log_file_ = nullptr;
  std::optional<Simulation> simulation_;
  std::optional<KeepResults> keep_results_;
  std::optional<ParameterRecorder> parameters_;
  std::optional<Recorder> recorder_;
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
