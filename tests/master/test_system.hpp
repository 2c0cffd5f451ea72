// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "io/config/command_line.hpp"
#include "mebots/modeldesc/archive.hpp"
#include "model/resolved_system.hpp"
#include "record/conditions.hpp"
#include "record/recorder.hpp"
#include "record/scenario.hpp"
#include "record/sink/csv_sink.hpp"
#include "resolve/resolve.hpp"
#include "run/simulation.hpp"
#include "support/files.hpp"

#include <atomic>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Contains code that the master's tests share, mostly for configs that use the probe FMU (tests/fmus/probe.c).
namespace mebots::test {

/// Replaces every "PROBE" in `text` by the path of the FMU made from tests/fmus/probe.c, and "COUPLING" by that of
/// coupling.c.
std::string with_probe(std::string text);

/// Creates a copy of a test FMU (tests/fmus/NAME.c) in which `text` replaces a part of the description. The destructor
/// deletes the copy.
class ChangedFmu {
 public:
  ChangedFmu(const std::string& name, const std::string& part, const std::string& text);
  std::filesystem::path path() const { return folder_.path() / "changed.fmu"; }

 private:
  modeldesc::TemporaryFolder folder_{"mebots-test"};
};

/// Returns the message of the InputError that `work` throws; "no InputError was thrown" if it throws none.
template <typename Work>
std::string input_error(Work work);

/// Applies the setting INSTANCE.VARIABLE=VALUE to the system, as `--set` does.
void apply_set(master::SystemDescription& system, const std::string& text);

/// Collects the messages of FMUs.
class Messages final : public master::MessageSink {
 public:
  void message(const Message& message) override {
    lines.push_back(std::string(message.instance) + "/" + std::string(message.category) + ": " +
                    std::string(message.text));
    severities.push_back(message.severity);
  }

  std::vector<std::string> lines;
  std::vector<Severity> severities;
};

/// Performs a complete run in this process, from the text of a config to the text of results.csv.
class TestRun {
 public:
  explicit TestRun(const std::string& config);

  master::Simulation& simulation() { return *simulation_; }
  TestRun& initialize();
  /// Initialises the run and steps to its end.
  TestRun& to_end();
  std::string csv();
  /// Returns the column of a variable in results.csv. `name` is the name without unit.
  std::vector<double> column(const std::string& name);

  modeldesc::TemporaryFolder folder{"mebots-test"};
  Messages messages;
  std::atomic<bool> interrupted{false};
  master::FmuLibrary library;
  master::SystemDescription description;
  master::ResolvedSystem system;
  std::optional<master::OutputFile> file;
  std::optional<master::Scenario> scenario;
  std::optional<master::Recorder> recorder;
  std::optional<master::Outcomes> outcomes;
  std::optional<master::StopConditions> stop_conditions;

 private:
  std::optional<master::Simulation> simulation_;
};

/// Contains exit code and output of the mebots program.
struct ProgramResult {
  int code = -1;
  std::string out;
  std::string err;
};

/// Runs the program with these arguments in `folder`.
ProgramResult run_program(const std::vector<std::string>& arguments, const std::filesystem::path& folder);

/// Runs a sandboxed FMU once. Returns which part of the sandbox this system rejects; empty if none. Tests that need the
/// sandbox are skipped with this text as the reason.
const std::string& sandbox_refusal();

template <typename Work>
std::string input_error(Work work) {
  try {
    work();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no InputError was thrown";
}

}  // namespace mebots::test
