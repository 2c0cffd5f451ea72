// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/sha256.hpp"
#include "mebots/run_options.hpp"
#include "mebots/state/visitor.hpp"
#include "model/resolved_system.hpp"
#include "record/observer.hpp"
#include "record/sink/output_file.hpp"
#include "run/input_hash.hpp"
#include "run/simulation.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace mebots::master {

inline constexpr const char* kCheckpointFile = "checkpoint.bin";

/// Contains the state of a run at a communication point. The run can be resumed from it in another process.
struct Checkpoint {
  std::filesystem::path config;  ///< path of the config, FMU or SSP
  RunOptions options;
  std::string inputs;  ///< the member `lines` of InputHash
  std::int64_t time_ns = 0;
  std::uint64_t results_bytes = 0;  ///< length of results.csv at this point
  std::uint64_t log_bytes = 0;      ///< length of log.txt at this point
  std::string results_hash;         ///< hash of the first results_bytes bytes
  std::string log_hash;
  std::vector<std::byte> simulation;

  void visit(state::Visitor& v) {
    v("config", config);
    v("options", options);
    v("inputs", inputs);
    v("time_ns", time_ns);
    v("results_bytes", results_bytes);
    v("log_bytes", log_bytes);
    v("results_hash", results_hash);
    v("log_hash", log_hash);
    v("simulation", simulation);
  }
};

/// Makes every path in the options absolute, because a checkpoint must be usable from any working folder.
RunOptions with_absolute_paths(RunOptions options);

/// Writes the checkpoint file of a results folder. Replaces an earlier checkpoint atomically. Throws Error if this
/// fails.
void write_checkpoint(const std::filesystem::path& folder, const Checkpoint& checkpoint);

/// Reads the checkpoint in a results folder. Throws InputError if the folder has no checkpoint, or if the checkpoint is
/// damaged or has another version.
Checkpoint read_checkpoint(const std::filesystem::path& folder);

/// Throws InputError if an instance's FMU cannot serialize its state. The error lists all such instances.
void check_can_checkpoint(const ResolvedSystem& system);

/// Throws InputError that lists the changes if the inputs have changed since a file was written. `what` names this file
/// in the error, for example "the checkpoint".
void check_inputs(const std::string& inputs_then, const std::string& inputs_now, std::string_view what);

/// Writes a checkpoint at t = 0, and then at the first communication point after each interval of simulated time.
/// Writes none at the end of the run, because a run that resumes there would step beyond the end. Must be the last
/// observer, so that all other observers have already written their data of the point.
class Checkpointer final : public Observer {
 public:
  /// `blank` must contain all members of the checkpoint that do not change during the run. All other arguments must
  /// outlive this object.
  Checkpointer(Simulation& simulation, std::filesystem::path folder, Checkpoint blank, OutputFile& results,
               OutputFile& log);

  void continues(const Point& point) override;
  void visit(state::Visitor& v) override { v("next_ns", next_ns_); }
  std::string_view state_name() const override { return "checkpoints"; }

 private:
  Simulation* simulation_;
  std::filesystem::path folder_;
  Checkpoint checkpoint_;
  OutputFile* results_;
  OutputFile* log_;
  GrowingFileHash results_hash_;
  GrowingFileHash log_hash_;
  std::int64_t next_ns_ = std::numeric_limits<std::int64_t>::min();
};

/// Contains the state, at a communication point, of a run that writes no files. Other runs with the same inputs can
/// start from it. In contrast, a Checkpoint belongs to one run, whose files contain the earlier results.
struct SavedRun {
  std::string inputs;  ///< the member `lines` of InputHash
  std::int64_t time_ns = 0;
  std::vector<std::byte> simulation;
  std::vector<std::byte> rows;  ///< rows of the MemorySink, if there is one

  void visit(state::Visitor& v) {
    v("inputs", inputs);
    v("time_ns", time_ns);
    v("simulation", simulation);
    v("rows", rows);
  }
};

std::vector<std::byte> to_bytes(const SavedRun& run);
/// Converts the bytes that to_bytes() returned to a SavedRun. Throws InputError if the bytes have another version.
SavedRun saved_run(std::span<const std::byte> bytes);

}  // namespace mebots::master
