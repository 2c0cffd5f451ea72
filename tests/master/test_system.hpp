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

/// Declares shared code of the master's tests, mostly for configs with the probe FMU (tests/fmus/probe.c).
namespace mebots::test {

/// Replaces "PROBE" and "COUPLING" in `text` by the paths of the FMUs from tests/fmus/probe.c and coupling.c.
std::string with_probe(std::string text);

/// A copy of a test FMU (tests/fmus/NAME.c) in which `text` replaces `part` of the description.
class ChangedFmu {
 public:
  ChangedFmu(const std::string& name, const std::string& part, const std::string& text);
  std::filesystem::path path() const { return folder_.path() / "changed.fmu"; }

 private:
  modeldesc::TemporaryFolder folder_{"mebots-test"};
};

/// Returns the message of the InputError that `work` throws, or "no InputError was thrown".
template <typename Work>
std::string input_error(Work work);

/// Applies INSTANCE.VARIABLE=VALUE to the system like `--set`.
void apply_set(master::SystemDescription& system, const std::string& text);

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

/// A complete run in this process, from the text of a config to the text of results.csv.
class TestRun {
 public:
  explicit TestRun(const std::string& config);

  master::Simulation& simulation() { return *simulation_; }
  TestRun& initialize();
  TestRun& to_end();
  std::string csv();
  /// Returns the column of a variable in results.csv. `name` contains no unit.
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

struct ProgramResult {
  int code = -1;
  std::string out;
  std::string err;
};

ProgramResult run_program(const std::vector<std::string>& arguments, const std::filesystem::path& folder);

/// Runs a sandboxed FMU once. Returns the reason why this system does not support the sandbox; empty if it does. Tests
/// that need the sandbox use it as the reason to skip.
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
