// SPDX-License-Identifier: Apache-2.0
#include "run/result_files.hpp"

#include "base/sha256.hpp"
#include "mebots/input_error.hpp"
#include "message/message_text.hpp"
#include "record/sink/csv_sink.hpp"
#include "run/live_scenario.hpp"

#include <fmt/format.h>

#include <array>

namespace mebots::master {

namespace {

/// The files that a new run replaces or deletes.
constexpr std::array<std::string_view, 8> kOutdated = {kSystemFile,     kSceneFile,       "summary.json",
                                                       "results.csv",   "results.h5",     "parameters.csv",
                                                       kCheckpointFile, kLiveScenarioFile};

void refuse_as_input(const std::filesystem::path& folder, const std::filesystem::path& input, std::string_view what) {
  for (const auto name : kOutdated) {
    std::error_code none;  // ignored, because the file usually does not exist
    if (!std::filesystem::equivalent(folder / name, input, none)) continue;
    throw InputError(ErrorCode::invalid_argument,
                     fmt::format("{}: the run would replace this file, its {}, with its own {}. Choose "
                                 "another folder with --out",
                                 input.string(), what, name));
  }
}

}  // namespace

std::optional<std::string> ResultFiles::KeepResults::reached(const Point& point) {
  if (point.step == 0) files_->keep(kOutdated);
  return std::nullopt;
}

void ResultFiles::keep(std::span<const std::string_view> outdated) {
  folder_.keep(outdated);
  if (hdf5_ != nullptr) hdf5_->renamed(folder() / "results.h5");
}

ResultFiles::ResultFiles(const RunOptions& options, const ResolvedSystem& system, const Checkpoint* resumed)
    : system_(&system), resumed_(resumed), folder_(options.out) {
  if (resumed == nullptr) {
    refuse_as_input(options.out, system.description->file, "config");
    for (const auto& file : options.scenarios) refuse_as_input(options.out, file, "scenario");
    for (const auto& input : system.description->inputs) refuse_as_input(options.out, input.file.path, "input");
    for (const auto& change : system.description->scenario) {
      if (change.file) refuse_as_input(options.out, change.file->path, "input");
    }
    if (system.description->record.csv) results_ = &folder_.create("results.csv");
    log_ = &folder_.create("log.txt");
    logging_ = true;
    return;
  }
  results_ = &folder_.reopen("results.csv");
  log_ = &folder_.reopen("log.txt");  // already contains the messages up to the checkpoint; started() truncates it
  if (results_->size() < resumed->results_bytes || log_->size() < resumed->log_bytes) {
    throw InputError(
        ErrorCode::state_damaged,
        fmt::format("{}: results.csv or log.txt is shorter than it was at the checkpoint; run the config again",
                    options.out.string()));
  }
  const auto verify = [](const std::filesystem::path& file, std::uint64_t bytes, const std::string& hash) {
    if (GrowingFileHash().up_to(file, bytes) == hash) return;
    throw InputError(
        ErrorCode::state_damaged,
        fmt::format("{}: its first {} bytes are not those that the run wrote up to its checkpoint; put them "
                    "back, or run the config again",
                    file.string(), bytes));
  };
  verify(results_->path(), resumed->results_bytes, resumed->results_hash);
  verify(log_->path(), resumed->log_bytes, resumed->log_hash);
}

std::filesystem::path ResultFiles::rows_file() const {
  return folder_.path() / (results_ != nullptr ? "results.csv" : "results.h5");
}

void ResultFiles::add_sinks(Recorder& recorder) {
  const auto& columns = recorder.columns();
  if (results_ != nullptr) recorder.add(std::make_unique<CsvSink>(columns, *results_));
  if (!system_->description->record.hdf5) return;
  auto sink = std::make_unique<Hdf5Sink>(columns, folder_.reserve("results.h5"));
  hdf5_ = sink.get();
  // Copies the rows from results.csv, because a killed process may have damaged its HDF5 file.
  if (resumed_ != nullptr) copy_csv_rows(results_->path(), resumed_->results_bytes, columns, *sink);
  recorder.add(std::move(sink));
}

std::vector<Observer*> ResultFiles::make_observers(Ensemble& ensemble) {
  std::vector<Observer*> observers{&keep_, &system_writer_.emplace(*system_, ensemble, folder())};
  if (!system_->description->record.parameters.empty()) {
    observers.push_back(&parameters_.emplace(*system_, ensemble, folder() / "parameters.csv"));
  }
  for (const auto& pictures : system_->description->pictures) {
    observers.push_back(
        &pictures_.emplace_back(*system_, ensemble, pictures, folder() / "pictures" / pictures.frame.text()));
  }
  return observers;
}

Observer& ResultFiles::make_checkpointer(Simulation& simulation, const RunOptions& options, const std::string& inputs) {
  Checkpoint blank;
  blank.config = system_->description->file;
  blank.options = with_absolute_paths(options);
  blank.inputs = inputs;
  return checkpointer_.emplace(simulation, folder(), std::move(blank), *results_, *log_);
}

void ResultFiles::started(Ensemble& ensemble) {
  if (resumed_ != nullptr) {
    log_->truncate(resumed_->log_bytes);
    logging_ = true;
    keep({});
  }
  if (hdf5_ != nullptr && !system_->description->record.parameters.empty()) {
    hdf5_->put_parameters(read_parameters(*system_, ensemble));
  }
}

void ResultFiles::log(const Message& message) {
  if (logging_) log_->append(message_text(message) + "\n");
}

std::optional<std::string> ResultFiles::close() {
  logging_ = false;
  std::optional<std::string> first;
  const auto close_one = [&first](auto* file) {
    try {
      if (file != nullptr) file->close();
    } catch (const std::exception& error) {
      if (!first) first = error.what();
    }
  };
  close_one(results_);
  close_one(hdf5_);
  close_one(log_);
  return first;
}

void ResultFiles::log_after_close(std::span<const std::string> lines) {
  OutputFile log(log_->path(), OutputFile::Mode::append);
  for (const auto& line : lines) log.append(line + "\n");
  log.close();
}

void ResultFiles::write_summary(const std::string& text) {
  write_whole(folder() / "summary.json", text);
}

bool ResultFiles::has_checkpoint() const {
  std::error_code ignored;
  return std::filesystem::exists(folder() / kCheckpointFile, ignored);
}

void ResultFiles::remove_checkpoint() {
  std::error_code ignored;
  std::filesystem::remove(folder() / kCheckpointFile, ignored);
}

}  // namespace mebots::master
