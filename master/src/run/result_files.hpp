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

/// The files of a run: system.json, scene.json.gz, results.csv, results.h5, parameters.csv, pictures, log.txt,
/// summary.json, checkpoint.bin, in one folder. Until the run has come to t = 0 an earlier run's files stay as they
/// are.
class ResultFiles {
 public:
  /// Makes the folder and the files that are always there, or opens those of the run that `resumed` goes on with.
  /// Throws InputError when it cannot. `system` and `resumed` must outlive this object; `resumed` null = a new run.
  ResultFiles(const std::filesystem::path& folder, const ResolvedSystem& system, const Checkpoint* resumed);

  const std::filesystem::path& folder() const { return folder_.path(); }
  /// True from t = 0 on: the results in the folder are this run's.
  bool kept() const { return folder_.kept(); }
  /// What is shown to people as the file of the rows.
  std::filesystem::path rows_file() const;

  /// Hands the recorder its sinks. Before the first point.
  void add_sinks(Recorder& recorder);
  /// Observers of which each belongs to a file, in their order. Before the first point; valid as long as this object.
  std::vector<Observer*> make_observers(Ensemble& ensemble);
  /// The one that writes checkpoints; to be the last of all observers.
  Observer& make_checkpointer(Simulation& simulation, const RunOptions& options, const std::string& inputs);
  /// What is written once all instances are initialised. Of a run that is resumed: cuts the log back, and goes on.
  void started(Ensemble& ensemble);

  /// A line of log.txt.
  void log(const Message& message);

  /// Closes results and log, once the recorder has handed over its rows. Returns what went wrong first; nothing when
  /// all is on the disk.
  std::optional<std::string> close();
  /// Adds lines to log.txt after close(). Throws Error.
  void log_after_close(std::span<const std::string> lines);
  /// Writes summary.json, whole or not at all. Throws Error.
  void write_summary(const std::string& text);
  bool has_checkpoint() const;
  /// There is nothing to go on with.
  void remove_checkpoint();
  /// All is written: another run may use the folder.
  void release() { folder_.release(); }

 private:
  /// Puts this run's files in the place of an earlier run's, once it has come to t = 0.
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
  Hdf5Sink* hdf5_ = nullptr;  // of the recorder; null without one
  std::optional<SystemFileWriter> system_writer_;
  std::optional<ParameterRecorder> parameters_;
  std::list<PictureRecorder> pictures_;  // whoever observes holds on to their addresses
  std::optional<Checkpointer> checkpointer_;
};

}  // namespace mebots::master
