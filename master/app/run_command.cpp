// SPDX-License-Identifier: Apache-2.0
#include "run_command.hpp"

#include "interrupt.hpp"

#include "mebots/master/command_line.hpp"
#include "mebots/master/conditions.hpp"
#include "mebots/master/console.hpp"
#include "mebots/master/picture_recorder.hpp"
#include "mebots/master/progress.hpp"
#include "mebots/master/recorder.hpp"
#include "mebots/master/simulation.hpp"
#include "mebots/master/summary.hpp"
#include "mebots/master/time.hpp"

#include <fmt/format.h>

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

/// The results folder, made and emptied of what an earlier run left that would be wrong now.
void prepare(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error || !std::filesystem::is_directory(folder)) {
    throw InputError(fmt::format("{}: the results folder cannot be made: {}. Choose another one with --out",
                                 folder.string(), error ? error.message() : "there is a file of this name"));
  }
  std::filesystem::remove(folder / "summary.json", error);
  if (error) {
    throw InputError(
        fmt::format("{}: an earlier summary.json cannot be removed: {}", folder.string(), error.message()));
  }
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
      simulate();
      if (report_.outcome == "interrupted") code = kFailed;
    } catch (const InputError& error) {
      code = fail(error.what(), kBadInput);
    } catch (const Error& error) {
      code = fail(error.what(), kFailed);
    } catch (const std::exception& error) {  // out of memory, say: the results so far are kept all the same
      code = fail(error.what(), kFailed);
    }
    return finish(code);
  }

 private:
  void open() {
    system_ = read_config(options_.config);
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
    for (const auto& pictures : system_.pictures) check_pictures(resolved_, pictures);

    out_ = options_.out.empty() ? std::filesystem::path("results") / system_.name : options_.out;
    prepare(out_);
    results_file_.emplace(out_ / "results.csv");
    log_file_.emplace(out_ / "log.txt");
    console_.set_log_file(&*log_file_);
    for (const auto& notice : resolved_.notices) console_.line("notice: " + notice);
  }

  void simulate() {
    report_.wall.initialise_s = timed([&] {
      simulation_.emplace(resolved_, console_);
      auto& ensemble = simulation_->ensemble();
      recorder_.emplace(resolved_, ensemble, *results_file_);
      for (const auto& pictures : system_.pictures) {
        simulation_->add(
            picture_recorders_.emplace_back(resolved_, ensemble, pictures, out_ / "pictures" / pictures.frame.text()));
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
    });
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
    if (simulation_) {
      report_.simulated_ns = simulation_->time_ns();
      report_.steps = simulation_->steps_done();
    }
    if (recorder_) report_.rows = recorder_->rows();
    console_.set_log_file(nullptr);
    for (auto* file : {&*results_file_, &*log_file_}) {
      try {
        file->close();
      } catch (const Error& error) {
        if (report_.error.empty()) fail(error.what(), kFailed);
        if (code == kRanToItsEnd) code = kFailed;
      }
    }
    const auto json = summary_json(resolved_, hash_, report_, values_ ? &*values_ : nullptr);
    try {
      OutputFile file(out_ / "summary.json");
      file.append(json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
      file.close();
    } catch (const Error& error) {
      std::error_code ignored;
      std::filesystem::remove(out_ / "summary.json", ignored);  // half a summary would mislead
      console_.error(error.what());
      if (code == kRanToItsEnd) code = kFailed;
    }
    if (report_.error.empty()) show_end(json);
    return code;
  }

  void show_end(const nlohmann::ordered_json& json) {
    console_.line(fmt::format("outcome: {} ({})", report_.outcome, report_.end_text));
    console_.line(fmt::format("simulated {} s in {} of stepping, {:.3g} x real time", to_seconds(report_.simulated_ns),
                              short_duration(report_.wall.stepping_s), report_.real_time_factor()));
    if (values_) show_values(values_->values(), json.at("units"), "");
    console_.line(fmt::format("results: {} ({} rows, {} columns), {}", (out_ / "results.csv").string(), report_.rows,
                              recorder_ ? recorder_->columns() : 0, (out_ / "summary.json").string()));
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
  std::filesystem::path out_;
  std::optional<OutputFile> results_file_;
  std::optional<OutputFile> log_file_;
  std::optional<Simulation> simulation_;
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
