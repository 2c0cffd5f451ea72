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

/// The files of a run in its results folder, such as results.csv, log.txt and summary.json. The files of an earlier run
/// remain until this run reaches its start time.
class ResultFiles {
 public:
  /// Creates the folder `options.out` and the files that every run has. If `resumed` is not null, opens the files of
  /// the resumed run instead. Throws InputError if this fails, or if a file of the run would replace an input. `system`
  /// and `resumed` must outlive this object.
  ResultFiles(const RunOptions& options, const ResolvedSystem& system, const Checkpoint* resumed);

  const std::filesystem::path& folder() const { return folder_.path(); }
  /// True if the results in the folder belong to this run, that is, after the start time was reached.
  bool kept() const { return folder_.kept(); }
  /// Returns the path of the file with the recorded rows.
  std::filesystem::path rows_file() const;

  /// Adds the result files to the recorder. Must be called before the first point.
  void add_sinks(Recorder& recorder);
  /// Creates the observers that write files, and returns them in the order of their calls. Must be called before the
  /// first point. The observers are valid as long as this object exists.
  std::vector<Observer*> make_observers(Ensemble& ensemble);
  /// Returns the observer that writes checkpoints. Must be added after all other observers.
  Observer& make_checkpointer(Simulation& simulation, const RunOptions& options, const std::string& inputs);
  /// Writes the files that describe the start. Must be called after initialisation. In a resumed run, also truncates
  /// the log at the checkpoint.
  void started(Ensemble& ensemble);

  void log(const Message& message);

  /// Closes results and log. The recorder must have written all rows. Returns the first error, or nullopt if all data
  /// are on the disk.
  std::optional<std::string> close();
  /// Appends lines to log.txt after close(). Throws Error if writing fails.
  void log_after_close(std::span<const std::string> lines);
  /// Replaces summary.json atomically. Throws Error if writing fails.
  void write_summary(const std::string& text);
  bool has_checkpoint() const;
  /// Removes the checkpoint of a run that has ended and cannot be resumed.
  void remove_checkpoint();
  /// Unlocks the folder. Nothing may be written afterwards.
  void release() { folder_.release(); }

 private:
  /// Replaces the files of an earlier run when this run reaches its start time.
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
  OutputFile* results_ = nullptr;  // null if the run writes no results.csv
  OutputFile* log_ = nullptr;
  bool logging_ = false;
  Hdf5Sink* hdf5_ = nullptr;  // owned by the recorder; null if the run writes no results.h5
  std::optional<SystemFileWriter> system_writer_;
  std::optional<ParameterRecorder> parameters_;
  std::list<PictureRecorder> pictures_;  // a list, because its elements must not move
  std::optional<Checkpointer> checkpointer_;
};

}  // namespace mebots::master
