// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "message/message_hub.hpp"
#include "record/observer.hpp"
#include "record/recorder.hpp"
#include "record/sink/hdf5_sink.hpp"
#include "run/checkpoint.hpp"
#include "run/result_folder.hpp"
#include "run/simulation.hpp"
#include "run/system_file.hpp"

#include <filesystem>
#include <list>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace mebots::master {

/// The files of a run in one folder: system.json, scene.json.gz, results.csv, results.h5, parameters.csv, pictures,
/// log.txt, summary.json, checkpoint.bin, live_scenario.json. An earlier run's files are unchanged until this run
/// reaches t = 0.
class ResultFiles {
 public:
  /// Creates the folder `options.out` and the files that every run has. If `resumed` continues an earlier run, opens
  /// the files of that run. Throws InputError if this fails, or if the files of the run would replace its inputs.
  /// `system` and `resumed` must outlive this object. If `resumed` is null, the run is new.
  ResultFiles(const RunOptions& options, const ResolvedSystem& system, const Checkpoint* resumed);

  const std::filesystem::path& folder() const { return folder_.path(); }
  /// True from t = 0 on, when the results in the folder belong to this run.
  bool kept() const { return folder_.kept(); }
  /// Returns the path of the file with the recorded rows, for messages.
  std::filesystem::path rows_file() const;

  /// Adds the files of results as sinks to the recorder. Must be called before the first point.
  void add_sinks(Recorder& recorder);
  /// Creates the observers that each write one file, and returns them in the order in which they must be called. Must
  /// be called before the first point. The observers are valid as long as this object.
  std::vector<Observer*> make_observers(Ensemble& ensemble);
  /// Returns the observer that writes checkpoints. It must be added after all other observers.
  Observer& make_checkpointer(Simulation& simulation, const RunOptions& options, const std::string& inputs);
  /// Writes the files that describe the start. Must be called after all instances are initialised. In a resumed run,
  /// truncates the log at the checkpoint and continues it.
  void started(Ensemble& ensemble);

  /// Writes a line to log.txt.
  void log(const Message& message);

  /// Closes the results and the log. The recorder must have written its rows before. Returns the first error; empty if
  /// all data are on the disk.
  std::optional<std::string> close();
  /// Adds lines to log.txt after close(). Throws Error.
  void log_after_close(std::span<const std::string> lines);
  /// Replaces summary.json atomically. Throws Error.
  void write_summary(const std::string& text);
  bool has_checkpoint() const;
  /// Removes the checkpoint of a run that cannot be resumed because it has ended.
  void remove_checkpoint();
  /// Unlocks the folder for other runs. Nothing may be written afterwards.
  void release() { folder_.release(); }

 private:
  /// At t = 0, replaces the files of an earlier run by those of this run.
  class KeepResults final : public Observer {
   public:
    explicit KeepResults(ResultFiles& files) : files_(&files) {}
    std::optional<std::string> reached(const Point& point) override;

   private:
    ResultFiles* files_;
  };

  void keep(std::span<const std::string_view> outdated);

  const ResolvedSystem* system_;
  const Checkpoint* resumed_;
  ResultFolder folder_;
  KeepResults keep_{*this};
  OutputFile* results_ = nullptr;  // null without results.csv
  OutputFile* log_ = nullptr;
  bool logging_ = false;
  Hdf5Sink* hdf5_ = nullptr;  // the recorder's; null without results.h5
  std::optional<SystemFileWriter> system_writer_;
  std::optional<ParameterRecorder> parameters_;
  std::list<PictureRecorder> pictures_;  // a list, because observers are referenced by address
  std::optional<Checkpointer> checkpointer_;
};

}  // namespace mebots::master
