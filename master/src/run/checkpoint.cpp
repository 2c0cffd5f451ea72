// SPDX-License-Identifier: Apache-2.0
#include "run/checkpoint.hpp"

#include "base/input_text.hpp"
#include "base/sha256.hpp"
#include "base/time.hpp"
#include "mebots/input_error.hpp"
#include "mebots/state/save.hpp"
#include "run/input_hash.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string_view>

namespace mebots::master {
namespace {

constexpr std::string_view kMagic = "mebots checkpoint 5\n";

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

}  // namespace

RunOptions with_absolute_paths(RunOptions options) {
  for (auto& file : options.scenarios) file = std::filesystem::absolute(file);
  for (auto& file : options.inputs) file = std::filesystem::absolute(file);
  if (!options.out.empty()) options.out = std::filesystem::absolute(options.out);
  return options;
}

void write_checkpoint(const std::filesystem::path& folder, const Checkpoint& checkpoint) {
  const auto bytes = state::save(checkpoint);
  const std::string_view content(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  std::string text(kMagic);
  text += sha256(content);
  text += content;
  write_whole(folder / kCheckpointFile, text, Durable::yes);
}

Checkpoint read_checkpoint(const std::filesystem::path& folder) {
  const auto path = folder / kCheckpointFile;
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) {
    throw InputError(ErrorCode::file_not_found,
                     fmt::format("{}: there is no checkpoint to resume from. A run writes checkpoints with "
                                 "--checkpoint-every, from t = 0 until shortly before its end; run the config again",
                                 path.string()));
  }
  const auto all = input_text(path);
  constexpr std::size_t kHashSize = 64;
  if (all.compare(0, kMagic.size(), kMagic) != 0 || all.size() < kMagic.size() + kHashSize) {
    throw InputError(ErrorCode::state_of_other_build,
                     fmt::format("{}: this is not a checkpoint of this version of mebots", path.string()));
  }
  const auto content = std::string_view(all).substr(kMagic.size() + kHashSize);
  if (all.compare(kMagic.size(), kHashSize, sha256(content)) != 0) {
    throw InputError(ErrorCode::state_damaged,
                     fmt::format("{}: this checkpoint is damaged; run the config again", path.string()));
  }
  Checkpoint checkpoint;
  state::restore(checkpoint, std::as_bytes(std::span(content)));
  return checkpoint;
}

void check_can_checkpoint(const ResolvedSystem& system) {
  std::vector<std::string> names;
  for (const auto& instance : system.instances) {
    const auto& ability = instance.implementation();
    if (ability.can_get_and_set_fmu_state && ability.can_serialize_fmu_state) continue;
    names.push_back(fmt::format("'{}' ({})", instance.description->name, instance.model->model_name));
  }
  if (names.empty()) return;
  throw InputError(ErrorCode::not_offered,
                   fmt::format("--checkpoint-every: these instances cannot write their state as bytes "
                               "(canGetAndSetFMUstate or canSerializeFMUstate is false): {}. Run without checkpoints",
                               fmt::join(names, ", ")));
}

void check_inputs(const std::string& inputs_then, const std::string& inputs_now, std::string_view what) {
  if (inputs_then == inputs_now) return;
  const auto before = lines_of(inputs_then);
  const auto now = lines_of(inputs_now);
  std::vector<std::string> changed;
  for (const auto& line : before) {
    if (std::find(now.begin(), now.end(), line) == now.end()) changed.push_back(line.substr(0, line.rfind(' ')));
  }
  for (const auto& line : now) {
    const auto name = line.substr(0, line.rfind(' '));
    const bool listed = std::find(changed.begin(), changed.end(), name) != changed.end();
    if (!listed && std::find(before.begin(), before.end(), line) == before.end()) changed.push_back(name);
  }
  throw InputError(
      ErrorCode::state_of_other_fmu,
      fmt::format("the inputs have changed since {} was written: {}. Restore them, or run the config again", what,
                  fmt::join(changed, ", ")));
}

Checkpointer::Checkpointer(Simulation& simulation, std::filesystem::path folder, Checkpoint blank, OutputFile& results,
                           OutputFile& log)
    : simulation_(&simulation),
      folder_(std::move(folder)),
      checkpoint_(std::move(blank)),
      results_(&results),
      log_(&log) {}

void Checkpointer::continues(const Point& point) {
  if (point.time_ns < next_ns_) return;
  const auto every_ns = nanoseconds_of(*checkpoint_.options.checkpoint_every_s, "time from checkpoint to checkpoint");
  const auto passed = point.time_ns / every_ns - (point.time_ns % every_ns < 0 ? 1 : 0);  // rounds down
  next_ns_ = (passed + 1) * every_ns;
  const auto state = simulation_->save_state();  // also makes the recorder write its rows to the file
  checkpoint_.simulation = simulation_->serialize(state);
  checkpoint_.time_ns = point.time_ns;
  // The files must be on the disk before a checkpoint refers to them.
  results_->sync();
  log_->sync();
  checkpoint_.results_bytes = results_->size();
  checkpoint_.log_bytes = log_->size();
  checkpoint_.results_hash = results_hash_.up_to(results_->path(), checkpoint_.results_bytes);
  checkpoint_.log_hash = log_hash_.up_to(log_->path(), checkpoint_.log_bytes);
  write_checkpoint(folder_, checkpoint_);
}

namespace {

constexpr std::string_view kSavedRunMagic = "mebots saved run 1\n";
constexpr std::size_t kHashSize = 64;

std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

std::vector<std::byte> to_bytes(const SavedRun& run) {
  const auto content = state::save(run);
  const auto hash = sha256(as_text(content));
  state::Writer writer;
  writer.append(kSavedRunMagic.data(), kSavedRunMagic.size());
  writer.append(hash.data(), hash.size());
  writer.append(content.data(), content.size());
  return writer.take();
}

SavedRun saved_run(std::span<const std::byte> bytes) {
  const auto text = as_text(bytes);
  if (!text.starts_with(kSavedRunMagic) || text.size() < kSavedRunMagic.size() + kHashSize) {
    throw InputError(ErrorCode::state_of_other_build, "this is not a saved state of a run of this version of mebots");
  }
  const auto content = bytes.subspan(kSavedRunMagic.size() + kHashSize);
  if (text.substr(kSavedRunMagic.size(), kHashSize) != sha256(as_text(content))) {
    throw InputError(ErrorCode::state_damaged, "this saved state of a run is damaged");
  }
  SavedRun run;
  state::restore(run, content);
  return run;
}

}  // namespace mebots::master
