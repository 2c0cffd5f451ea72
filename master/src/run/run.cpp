// SPDX-License-Identifier: Apache-2.0
#include "run/run.hpp"

#include "base/input_text.hpp"
#include "base/own_threads.hpp"
#include "base/sha256.hpp"
#include "base/signal_guard.hpp"
#include "base/time.hpp"
#include "fmi/call/exit_guard.hpp"
#include "io/config/command_line.hpp"
#include "io/config/load_system.hpp"
#include "mebots/assert.hpp"
#include "mebots/file_kind.hpp"
#include "mebots/input_error.hpp"
#include "mebots/nearest_names.hpp"
#include "mebots/state/save.hpp"
#include "message/message_text.hpp"
#include "model/name_pattern.hpp"
#include "model/resolved_system.hpp"
#include "record/sink/csv_sink.hpp"
#include "slave/process_watch.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <iterator>
#include <limits>

namespace mebots::master {
namespace {

/// Adds the wall time of a scope to `total_s`, even if an exception leaves the scope.
class Stopwatch {
 public:
  explicit Stopwatch(double& total_s) : total_s_(&total_s) {}
  ~Stopwatch() { *total_s_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  double* total_s_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Returns the times in the options. An FMU or SSP may lack a step and a stop time; a config contains both.
GivenTimes given_times(const std::filesystem::path& config, const RunOptions& options) {
  GivenTimes times;
  times.step = options.step_s;
  if (options.stop_time_s && find_system(config).form != SystemForm::config)
    times.stop_time_s = to_seconds(nanoseconds_of(*options.stop_time_s, "stop time"));
  return times;
}

void check_times(const RunOptions& options) {
  if (options.stop_time_s) static_cast<void>(nanoseconds_of(*options.stop_time_s, "stop time"));
  if (const auto* step_s = options.step_s ? std::get_if<double>(&*options.step_s) : nullptr) {
    static_cast<void>(duration_of(*step_s, "step"));
  }
  if (options.checkpoint_every_s) {
    static_cast<void>(duration_of(*options.checkpoint_every_s, "time from checkpoint to checkpoint"));
  }
}

}  // namespace

Run::Run(const std::filesystem::path& config, RunOptions options, std::shared_ptr<FmuLibrary> library)
    : options_(std::move(options)), library_(std::move(library)) {
  const auto settings = std::exchange(options_.settings, {});
  const auto scenarios = std::exchange(options_.scenarios, {});
  const auto inputs = std::exchange(options_.inputs, {});
  const auto stop_time_s = options_.stop_time_s;
  check_times(options_);
  system_ = read_config(config, given_times(config, options_));
  for (const auto& instance : system_.instances) parameters_of_config_.push_back(instance.parameters.size());
  for (const auto& setting : settings) set(setting);
  for (const auto& file : scenarios) add_scenario(file);
  for (const auto& file : inputs) add_inputs(file);
  if (stop_time_s) set_stop_time(nanoseconds_of(*stop_time_s, "stop time"), "stop time");
  if (const auto patterns = options_.record) record(*patterns);
}

Run::Run(Checkpoint checkpoint, const std::filesystem::path& folder) : Run(checkpoint.config, checkpoint.options) {
  options_.out = folder;
  checkpoint_ = std::move(checkpoint);
}

std::unique_ptr<Run> Run::resume(const std::filesystem::path& folder, bool in_memory) {
  auto checkpoint = read_checkpoint(folder);
  checkpoint.options.in_memory = in_memory;
  return std::unique_ptr<Run>(new Run(std::move(checkpoint), folder));
}

Run::~Run() {
  close();
  try {
    const Busy busy(*this, "the end of the run");
    free_fmus();
  } catch (...) {  // NOLINT(bugprone-empty-catch): already reported; a destructor must not throw
  }
}

Run::Busy::Busy(Run& run, std::string_view what) : run_(&run) {
  if (run.busy_) {
    throw InputError(ErrorCode::wrong_call_order,
                     fmt::format("{} was called from a listener or another thread in the middle of a step. Call "
                                 "interrupt() to end the run after this step",
                                 what));
  }
  run.busy_ = true;
  pthread_setcancelstate(PTHREAD_CANCEL_DISABLE, &cancel_state_);
}

Run::Busy::~Busy() {
  pthread_setcancelstate(cancel_state_, nullptr);
  run_->busy_ = false;
}

void Run::require_open(std::string_view what) const {
  if (state_ == RunState::open && !busy_) return;
  throw InputError(ErrorCode::wrong_call_order,
                   fmt::format("{} is too late: the run is {} at {} s, and settings can change only before its start",
                               what, name_of(state_), to_seconds(time_ns())));
}

void Run::require_alive(std::string_view what) const {
  if (state_ == RunState::failed) {
    throw InputError(ErrorCode::wrong_call_order,
                     fmt::format("{}: the run failed, so its FMUs can no longer be called: {}", what, report_.error));
  }
  if (!initialised_) {
    throw InputError(ErrorCode::wrong_call_order, fmt::format("{}: the run has not reached t = 0", what));
  }
}

void Run::listen(MessageHub::Listener listener) {
  require_open("listen");
  messages_.add(std::move(listener));
}

void Run::set(const Setting& written) {
  require_open(written.place);
  const auto setting = with_longest_name(
      written, [this](const std::string& name) { return !matching_variables(system_, *library_, name).empty(); });
  const auto checked = checked_settings(system_, *library_, setting);
  add_assignments(checked);
  options_.settings.push_back(setting);
  const bool resizes = std::ranges::any_of(checked, &CheckedSetting::is_size);
  if (!resizes || std::ranges::none_of(options_.settings, is_pattern, &Setting::variable)) return;
  try {
    assign_again();
  } catch (...) {  // the invalid setting must have no effect
    options_.settings.pop_back();
    setting_changes_.resize(setting_changes_.size() - checked.size());
    for (const auto& one : checked) one.located.instance->parameters.pop_back();
    throw;
  }
}

void Run::add_assignments(const std::vector<CheckedSetting>& checked) {
  for (const auto& [located, text, is_size] : checked) {
    located.instance->parameters.push_back(located.assignment);
    setting_changes_.push_back(text);
  }
}

/// Applies all settings again after the size of an array changed, so that patterns match the present elements. If this
/// fails, nothing has changed.
void Run::assign_again() {
  std::vector<CheckedSetting> checked;
  for (const auto& setting : options_.settings)
    std::ranges::move(checked_settings(system_, *library_, setting), std::back_inserter(checked));
  for (std::size_t i = 0; i < system_.instances.size(); ++i) {
    auto& parameters = system_.instances[i].parameters;
    parameters.erase(parameters.begin() + static_cast<std::ptrdiff_t>(parameters_of_config_[i]), parameters.end());
  }
  setting_changes_.clear();
  add_assignments(checked);
}

void Run::add_scenario(const std::filesystem::path& file) {
  require_open("a scenario");
  scenario_changes_.push_back(apply_scenario(system_, file));
  options_.scenarios.push_back(std::filesystem::absolute(file));
}

void Run::add_inputs(const std::filesystem::path& file) {
  require_open("a file of inputs");
  InputsDescription inputs;
  inputs.file.path = std::filesystem::absolute(file);
  inputs.file.name = file.filename().string();
  inputs.file.place = "inputs";
  if (is_there(inputs.file.path) && !is_file(inputs.file.path)) {
    throw InputError(
        ErrorCode::file_unreadable,
        fmt::format("{}: this is not a file but a pipe, folder or device; a run reads its inputs more than "
                    "once",
                    file.string()));
  }
  inputs_changes_.push_back(fmt::format("inputs {} {}", inputs.file.name, sha256(input_text(file))));
  system_.inputs.push_back(std::move(inputs));
  options_.inputs.push_back(std::filesystem::absolute(file));
}

void Run::set_stop_time(std::int64_t stop_time_ns, const std::string& place) {
  require_open(place);
  master::set_stop_time(system_, stop_time_ns, place);
  options_.stop_time_s = to_seconds(stop_time_ns);
}

void Run::record(const std::vector<std::string>& patterns) {
  require_open("record");
  system_.record.patterns.emplace();
  for (const auto& pattern : patterns) system_.record.patterns->push_back({pattern, "record"});
  system_.record.exclude.clear();
  options_.record = patterns;
}

/// Returns the changes to the config as texts. Equal changes have equal texts, regardless of their order and of the
/// interface (command line, C++ or Python).
std::vector<std::string> Run::changes() const {
  std::vector<std::string> texts;
  if (options_.step_s) texts.push_back(fmt::format("step {}", time_text(*options_.step_s)));
  texts.insert(texts.end(), setting_changes_.begin(), setting_changes_.end());
  texts.insert(texts.end(), scenario_changes_.begin(), scenario_changes_.end());
  texts.insert(texts.end(), inputs_changes_.begin(), inputs_changes_.end());
  if (options_.stop_time_s) texts.push_back(fmt::format("stop_time {}", *options_.stop_time_s));
  if (options_.record) texts.push_back(fmt::format("record {}", nlohmann::json(*options_.record).dump()));
  return texts;
}

void Run::add(Observer& observer) {
  require_open("an observer");
  added_.push_back(&observer);
}

void Run::add_foreign(Observer& observer) {
  add(observer);
  has_foreign_ = true;
}

void Run::load() {
  require_open("load()");
  static_cast<void>(resolve(system_, *library_, interrupted_));
}

void Run::start_from(std::span<const std::byte> state) {
  require_open("start_from()");
  if (!options_.out.empty()) {
    throw InputError(ErrorCode::invalid_argument,
                     "start_from(): a run that starts from a saved state has no results of the time before it; remove "
                     "the results folder");
  }
  past_ = saved_run(state);
}

std::vector<std::byte> Run::save_state() {
  require_alive("save_state()");
  const Busy busy(*this, "save_state()");
  if (state_ == RunState::ended) {
    throw InputError(ErrorCode::wrong_call_order,
                     "save_state(): the run has ended, so no run can start from its state");
  }
  if (!options_.out.empty()) {
    throw InputError(ErrorCode::invalid_argument,
                     "save_state(): this run writes files, and its state is incomplete without them; remove the "
                     "results folder, or write checkpoints instead");
  }
  require_whole_states(resolved_, "save_state()");
  SavedRun saved;
  saved.inputs = hash_.lines;
  saved.time_ns = time_ns();
  attempt([&] {
    saved.simulation = simulation_->serialize(simulation_->save_state());
    if (memory_ == nullptr) return;
    recorder_->flush();
    state::Writer writer;
    state::Saver saver(writer);
    memory_->visit_rows(saver);
    saved.rows = writer.take();
  });
  // Checked again, because an FMU in another process reports data outside its instances only with its state.
  require_whole_states(resolved_, "save_state()");
  return to_bytes(saved);
}

void Run::say(Severity severity, std::string_view category, const std::string& text) {
  messages_.message({{}, severity, category, text, time_ns()});
}

template <typename Work>
void Run::attempt(Work work) {
  try {
    work();
    messages_.rethrow();
  } catch (const InterruptedError&) {  // before the start time, the run has no point at which it can end
    report_.end_reason = EndReason::interrupted;
    report_.outcome = name_of(EndReason::interrupted);
    report_.end_text = checkpoint_ ? "interrupted before the checkpoint was reached" : "interrupted before t = 0";
    state_ = RunState::ended;
  } catch (const Error& error) {
    fail(error.code(), error.what());
    throw;
  } catch (const std::exception& error) {
    fail(ErrorCode::unspecified, error.what());
    throw;
  } catch (...) {
    fail(ErrorCode::unspecified, "a listener threw an object that is not an exception");
    throw;
  }
}

void Run::start() {
  if (state_ == RunState::failed) require_alive("start");
  const Busy busy(*this, "start()");
  begin();
}

void Run::begin() {
  if (state_ != RunState::open) return;
  attempt([this] {
    {
      const Stopwatch watch(report_.wall.open_s);
      open();
    }
    {
      const Stopwatch watch(report_.wall.initialise_s);
      initialise();
    }
    initialised_ = true;
    state_ = RunState::ready;
    if (simulation_->ended()) finish();
  });
}

void Run::open() {
  install_crash_notice();
  take_kept_signal();  // discards a signal that arrived before this run
  MEBOTS_ASSERT(state_ == RunState::open && !simulation_);
  if (options_.isolate) {
    for (auto& instance : system_.instances) {
      if (!instance.isolation.alone()) instance.isolation.process = ProcessKind::own;
    }
  }
  adopt_threads_of_fork();
  library_->forget_changed();
  resolved_ = resolve(system_, *library_, interrupted_);
  report_.overrides = changes();
  hash_ = hash_inputs(system_, report_.overrides);
  if (options_.checkpoint_every_s) {
    check_can_checkpoint(resolved_);
    if (options_.out.empty())
      throw InputError(ErrorCode::invalid_argument, "checkpoints need a folder for the results");
    if (!system_.record.csv) {
      throw InputError(ErrorCode::invalid_value,
                       "checkpoints need results.csv; set \"format\" under \"record\" to \"both\"");
    }
  }
  if (checkpoint_) check_inputs(checkpoint_->inputs, hash_.lines, "the checkpoint");
  if (past_) {
    check_inputs(past_->inputs, hash_.lines, "the saved state");
    require_whole_states(resolved_, "start_from()");
  }
  recorded_variables(resolved_);  // throws InputError if a pattern matches no variable
  recorded_parameters(resolved_);
  for (const auto& pictures : system_.pictures) check_pictures(resolved_, pictures);
  scenario_.emplace(resolved_);
  if (!options_.out.empty()) {
    files_.emplace(options_, resolved_, checkpoint_ ? &*checkpoint_ : nullptr);
    live_scenario_.emplace(options_.out);
    messages_.add([this](const Message& message) { files_->log(message); });
  }
  report_.notices = resolved_.notices;
  for (const auto& notice : resolved_.notices) say(Severity::info, "notice", notice);
}

void Run::initialise() {
  MEBOTS_ASSERT(scenario_.has_value() && !simulation_, "open() comes first, and once");
  SlaveOptions slaves;
  slaves.statistics = options_.statistics ? &statistics_ : nullptr;
  slaves.solvers = &solvers_;
  slaves.losses = &losses_;
  slaves.overrides = &scenario_->schedule();
  slaves.interrupted = &interrupted_;
  const auto is_here = [](const ResolvedInstance& instance) { return !instance.description->isolation.alone(); };
  if (std::ranges::any_of(resolved_.instances, is_here)) copies_.emplace();
  process_use_.emplace(resolved_);
  simulation_.emplace(resolved_, messages_, slaves);
  auto& ensemble = simulation_->ensemble();
  scenario_->watch(resolved_, ensemble);
  recorder_.emplace(resolved_, ensemble);
  if (options_.in_memory) {
    auto sink = std::make_unique<MemorySink>(recorder_->columns());
    memory_ = sink.get();
    if (checkpoint_) {
      copy_csv_rows(options_.out / "results.csv", checkpoint_->results_bytes, recorder_->columns(), *sink);
    } else if (past_) {
      if (past_->rows.empty()) {
        throw InputError(
            ErrorCode::invalid_argument,
            "the saved state has no rows, because its run recorded none in memory, but this run records in memory");
      }
      state::Reader reader(past_->rows);
      state::Restorer restorer(reader);
      sink->visit_rows(restorer);
    }
    recorder_->add(std::move(sink));
  }
  if (files_) files_->add_sinks(*recorder_);
  note_slaves(ensemble);
  values_.emplace(resolved_, ensemble);
  outcomes_.emplace(resolved_, ensemble);
  stop_conditions_.emplace(resolved_, ensemble);
  if (system_.coupling) coupling_.emplace(resolved_, ensemble);

  simulation_->add(*scenario_);
  if (files_) {
    for (auto* observer : files_->make_observers(ensemble)) simulation_->add(*observer);
  }
  for (Observer* observer :
       std::initializer_list<Observer*>{&*recorder_, &*values_, &*outcomes_, &*stop_conditions_, &write_saver_}) {
    simulation_->add(*observer);
  }
  if (coupling_) simulation_->add(*coupling_);
  for (auto* observer : added_) simulation_->add(*observer);
  if (options_.checkpoint_every_s) {
    simulation_->add(files_->make_checkpointer(*simulation_, options_, hash_.lines));
  }

  if (checkpoint_) {
    simulation_->resume(checkpoint_->simulation);
    live_scenario_->resume(time_ns());
  } else if (past_) {
    simulation_->resume(past_->simulation);
    past_->simulation = {};
    past_->rows = {};
  } else {
    simulation_->initialize();
  }
  // Logged before the old log is continued, so that the complete log equals that of an uninterrupted run.
  if (checkpoint_) say(Severity::info, "notice", fmt::format("resumed at {} s", to_seconds(time_ns())));
  if (files_) files_->started(ensemble);
}

void Run::note_slaves(Ensemble& ensemble) {
  for (std::size_t i = 0; i < ensemble.size(); ++i) {
    for (const auto& notice : ensemble.slave(i).notices()) {
      report_.notices.push_back(fmt::format("{}: {}", ensemble.name(i), notice));
      say(Severity::warning, "notice", report_.notices.back());
    }
  }
}

/// Steps until `until_ns`. Checks the state of the process only after steps 1, 2, 4, 8 ... and at the end, because a
/// check takes longer than a step. Every 64 steps, checks the signal mask, because a changed mask could block
/// interrupts.
void Run::step_until(std::int64_t until_ns) {
  std::optional<ProcessWatch> watch;
  if (!has_foreign_ && until_ns > next_point_ns()) watch.emplace(resolved_, messages_);
  auto seen_ns = time_ns();
  const auto look = [&] {
    if (watch)
      watch->look(fmt::format("in steps from {} s to {} s", to_seconds(seen_ns), to_seconds(time_ns())), time_ns());
    seen_ns = time_ns();
  };
  std::int64_t steps = 0;
  std::int64_t look_at = 1;
  while (simulation_->time_ns() < until_ns) {
    set_again();
    if (!simulation_->step()) break;
    state_ = RunState::running;
    messages_.rethrow();
    if (const auto text = take_kept_signal()) throw SlaveError(*text);
    constexpr std::int64_t kStepsPerMaskLook = 64;
    const bool looks = ++steps == look_at;
    if (looks) look_at *= 2;
    if (looks || (steps % kStepsPerMaskLook == 0 && watch && watch->is_mask_changed())) look();
  }
  look();
}

/// Sets the values that the user set on the live page after the checkpoint, before the earlier process was killed.
void Run::set_again() {
  if (live_scenario_ && live_scenario_->is_pending()) at_point([&] { write_due(); });
}

void Run::write_due() {
  for (const auto& [variable, value] : live_scenario_->due(time_ns()))
    write_variable(*this, variable, value, "set by hand");
}

void Run::advance(std::int64_t until_ns, std::string_view what) {
  if (state_ == RunState::failed) require_alive(what);
  const Busy busy(*this, what);
  begin();
  if (state_ == RunState::ended) return;
  attempt([&] {
    {
      const Stopwatch watch(report_.wall.stepping_s);
      step_until(until_ns);
    }
    if (simulation_->ended()) finish();
  });
}

std::int64_t Run::next_point_ns() const {
  const auto grid = system_.grid();
  return grid.time_ns((simulation_ ? simulation_->grid_point() : 0) + 1);
}

bool Run::step() {
  if (state_ == RunState::open) start();
  const auto from = simulation_ ? simulation_->grid_point() : 0;
  advance(next_point_ns(), "step()");
  return simulation_ && simulation_->grid_point() > from;
}

void Run::run_until(std::int64_t time_ns) {
  advance(time_ns, "run_until()");
}

void Run::run() {
  advance(std::numeric_limits<std::int64_t>::max(), "run()");
}

void Run::call(std::size_t instance, std::string_view what, const std::function<void(Slave&)>& work) {
  require_alive(what);
  if (freed_) throw InputError(ErrorCode::wrong_call_order, fmt::format("{}: the run's instances were freed", what));
  if (busy_ && !at_point_) const Busy refused(*this, what);
  attempt([&] { work(simulation_->ensemble().slave(instance)); });
}

void Run::at_point(const std::function<void()>& work) {
  at_point_ = initialised_;  // variables cannot be read before the start time
  try {
    work();
  } catch (...) {
    at_point_ = false;
    throw;
  }
  at_point_ = false;
}

void Run::finish() {
  MEBOTS_ASSERT(simulation_ && simulation_->ended());
  const auto& end = simulation_->end();
  report_.end_reason = end.reason;
  report_.end_text = end.text;
  const bool cut_short = end.reason == EndReason::interrupted || end.reason == EndReason::closed;
  report_.outcome = cut_short ? std::string(name_of(end.reason)) : outcomes_->outcome();
  state_ = RunState::ended;
  ProcessWatch watch(resolved_, messages_);
  try {
    simulation_->terminate();
  } catch (const Error& error) {
    // If an interrupt stopped a call to an instance, `end.text` already contains this error.
    if (end.reason != EndReason::interrupted) {
      report_.notices.push_back(fmt::format("error after the end of the run: {}", error.what()));
      say(Severity::warning, "notice", report_.notices.back());
      const bool lost = error.code() == ErrorCode::fmu_lost || error.code() == ErrorCode::fmu_timeout;
      if (lost) report_.faults.emplace_back(error.what());
    }
  }
  watch.look("while instances were terminated", time_ns());
  if (const auto text = copies_ ? copies_->returned() : std::nullopt) report_fault(*text);
  if (const auto text = take_kept_signal()) report_fault(*text);
  process_use_.reset();  // no FMU of the run computes afterwards
  if (coupling_) {
    for (const auto& warning : coupling_->warnings()) {
      report_.notices.push_back(warning);
      say(Severity::warning, "coupling", warning);
    }
  }
  messages_.rethrow();
  write_reports();
  if (frees_at_end_) free_fmus();
  release_files();
  if (state_ == RunState::failed) throw Error(ErrorCode::file_unwritable, report_.error);
}

void Run::report_fault(const std::string& text) {
  report_.faults.push_back(text);
  report_.notices.push_back(fmt::format("error after the end of the run: {}", text));
  say(Severity::error, "notice", report_.notices.back());
}

/// Frees the FMUs. Must be called after the results are on the disk, because an FMU may crash in this call.
void Run::free_fmus(bool unloads) {
  if (freed_ || !simulation_) return;
  freed_ = true;
  ProcessWatch watch(resolved_, messages_);
  auto faults = simulation_->free_instances();
  if (unloads && library_.use_count() == 1) {  // otherwise, a later run uses the FMUs
    for (const auto& instance : resolved_.instances) {
      try {
        instance.fmu->unload();
      } catch (const Error& error) {
        faults.emplace_back(error.what());
      }
    }
  }
  watch.look("when it was freed", time_ns());
  if (faults.empty()) return;
  std::vector<std::string> lines;
  for (const auto& fault : faults) {
    report_.faults.push_back(fault);
    report_.notices.push_back(fmt::format("error after the end of the run: {}", fault));
    lines.push_back(message_text({{}, Severity::error, "notice", report_.notices.back(), time_ns()}));
  }
  if (!frees_at_end_ || !files_ || !files_->kept()) return;
  files_->log_after_close(lines);
  write_summary();
}

std::vector<Leftover> Run::free_instances() {
  close();
  const Busy busy(*this, "free_instances()");
  free_fmus(false);
  process_use_.reset();
  return leftovers_of(resolved_);
}

void Run::fail(ErrorCode code, const std::string& what) noexcept {
  if (state_ == RunState::failed) return;
  state_ = RunState::failed;
  report_.end_reason = EndReason::failed;
  report_.outcome = name_of(EndReason::failed);
  report_.end_text = "the simulation failed";
  report_.error = what;
  report_.error_code = code;
  process_use_.reset();
  write_reports();
  release_files();
}

void Run::write_reports() noexcept {
  if (!simulation_) return;
  report_.simulated_ns = simulation_->time_ns() - system_.start_time_ns;
  report_.steps = simulation_->steps_done();
  report_.rows = recorder_ ? recorder_->rows() : 0;
  if (files_ && !files_->kept()) return;  // the start time was not reached, so the folder stays unchanged
  const auto note = [this](const std::string& problem) {
    if (!report_.error.empty()) return;
    state_ = RunState::failed;
    report_.end_reason = EndReason::failed;
    report_.outcome = name_of(EndReason::failed);
    report_.error = problem;
    report_.error_code = ErrorCode::file_unwritable;
  };
  try {
    if (recorder_) recorder_->flush();
  } catch (const std::exception& error) {
    note(error.what());
  }
  if (!files_) return;
  if (const auto problem = files_->close()) note(*problem);
  try {
    write_summary();
  } catch (const std::exception& error) {
    note(error.what());
  }
  const bool to_go_on_with = report_.end_reason == EndReason::failed || report_.end_reason == EndReason::interrupted ||
                             report_.end_reason == EndReason::closed;
  if (!to_go_on_with) files_->remove_checkpoint();
}

void Run::write_summary() {
  files_->write_summary(summary().dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
}

/// Unlocks the results folder for other runs.
void Run::release_files() noexcept {
  if (files_ && files_->kept()) files_->release();
}

void Run::close() noexcept {
  if (busy_) return interrupt();
  if (state_ != RunState::ready && state_ != RunState::running) return;
  try {
    const Busy busy(*this, "close()");
    attempt([this] {
      simulation_->finish({EndReason::closed, fmt::format("closed at {} s", to_seconds(time_ns()))});
      finish();
    });
  } catch (...) {  // NOLINT(bugprone-empty-catch): it is in the report
  }
}

std::string Run::outcome() const {
  if (state_ == RunState::ended || state_ == RunState::failed) return report_.outcome;
  return outcomes_ ? outcomes_->outcome() : "";
}

nlohmann::ordered_json Run::summary() const {
  if (!values_) return nlohmann::ordered_json::object();
  auto report = report_;
  report.outcome = outcome();
  report.simulated_ns = simulation_->time_ns() - system_.start_time_ns;
  report.steps = simulation_->steps_done();
  report.rows = recorder_->rows();
  auto json = summary_json(resolved_, hash_, report, *values_);
  if (!system_.scenario.empty()) json["scenario"] = scenario_->report(resolved_, simulation_->time_ns());
  for (const auto& loss : losses()) {
    json["lost_instances"][loss.name] = {{"at", to_seconds(*loss.at_ns)}, {"error", loss.text}};
  }
  if (uncertainty_) json["uncertainty"] = *uncertainty_;
  if (coupling_) json["coupling"] = coupling_->json();
  if (const auto* steps = simulation_->step_statistics()) json["step_control"] = step_control_json(resolved_, *steps);
  if (!solvers_.empty()) json["solvers"] = solvers_json(solvers_);
  if (options_.statistics) json["statistics"] = statistics_json(statistics_, report.wall.simulating_s());
  return json;
}

std::vector<InstanceLoss> Run::losses() const {
  std::vector<InstanceLoss> lost;
  std::ranges::copy_if(losses_, std::back_inserter(lost),
                       [](const InstanceLoss& loss) { return loss.at_ns.has_value(); });
  return lost;
}

const ResolvedSystem& Run::resolved() const {
  require_alive("reading a variable");
  return resolved_;
}

void Run::report_uncertainty(const nlohmann::ordered_json& uncertainty) {
  uncertainty_ = std::make_unique<nlohmann::ordered_json>(uncertainty);
  if (files_ && files_->kept()) write_summary();
}

void Run::set_by_hand(std::string_view variable, double value) {
  write_due();  // first sets values that a resumed run must set again at this time
  const auto written = write_variable(*this, variable, value, "set by hand");
  live_scenario_->add(variable, written, time_ns());
}

void Run::note_write(const std::string& text) {
  constexpr std::size_t kMostListed = 1000;  // limits the list, because a program may write at every step
  if (report_.writes.size() == kMostListed) {
    ++report_.further_writes;
    return;
  }
  report_.writes.push_back(fmt::format("{} at {} s", text, to_seconds(time_ns())));
}

const MemorySink& Run::memory() {
  if (memory_ == nullptr) {
    throw InputError(ErrorCode::wrong_call_order,
                     "nothing is recorded in memory: the run has not started, or does not record into memory");
  }
  if (state_ == RunState::ready || state_ == RunState::running) attempt([this] { recorder_->flush(); });
  return *memory_;
}

}  // namespace mebots::master
