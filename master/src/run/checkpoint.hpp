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

/// The state of a run at a communication point. Another process can resume the run from this state.
struct Checkpoint {
  std::filesystem::path config;  ///< path of the config, FMU or SSP
  RunOptions options;
  std::string inputs;  ///< the text of all inputs, see InputHash::lines
  std::int64_t time_ns = 0;
  std::uint64_t results_bytes = 0;  ///< length of results.csv at this point
  std::uint64_t log_bytes = 0;      ///< length of log.txt at this point
  std::string results_hash;         ///< hash of the first `results_bytes` bytes of results.csv
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

/// Makes all paths in the options absolute, because a checkpoint may be resumed from another working folder.
RunOptions with_absolute_paths(RunOptions options);

/// Writes the checkpoint file into a results folder. Replaces an earlier checkpoint atomically. Throws Error if writing
/// fails.
void write_checkpoint(const std::filesystem::path& folder, const Checkpoint& checkpoint);

/// Reads the checkpoint in a results folder. Throws InputError if the folder has no checkpoint, or if the checkpoint is
/// damaged or has another version.
Checkpoint read_checkpoint(const std::filesystem::path& folder);

/// Throws InputError if an instance's FMU cannot serialize its state. The error lists all such instances.
void check_can_checkpoint(const ResolvedSystem& system);

/// If the inputs have changed, throws InputError that lists the changes. `what` names the older state in the error, for
/// example "the checkpoint".
void check_inputs(const std::string& inputs_then, const std::string& inputs_now, std::string_view what);

/// An observer that writes a checkpoint at the start, and then at the first communication point after each interval of
/// simulated time. Must be the last observer, because a checkpoint contains the states of all other observers. Writes
/// no checkpoint at the end of the run, because a resumed run would step past the end.
class Checkpointer final : public Observer {
 public:
  /// `blank` must contain all members that do not change during the run, such as the config and the options. All other
  /// arguments must outlive this object.
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

/// The state of a run without files at a communication point. Other runs with the same inputs can start from it. In
/// contrast, a Checkpoint belongs to one run and its files.
struct SavedRun {
  std::string inputs;  ///< the text of all inputs, see InputHash::lines
  std::int64_t time_ns = 0;
  std::vector<std::byte> simulation;
  std::vector<std::byte> rows;  ///< rows of the MemorySink; empty without a MemorySink

  void visit(state::Visitor& v) {
    v("inputs", inputs);
    v("time_ns", time_ns);
    v("simulation", simulation);
    v("rows", rows);
  }
};

std::vector<std::byte> to_bytes(const SavedRun& run);
/// Converts the result of to_bytes() back. Throws InputError if the bytes are damaged or of another version.
SavedRun saved_run(std::span<const std::byte> bytes);

}  // namespace mebots::master
