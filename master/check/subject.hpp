// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "child.hpp"

#include "fmi/call/callbacks.hpp"
#include "fmi/call/foreign_call.hpp"
#include "fmi/process/process_state.hpp"
#include "mebots/error.hpp"
#include "mebots/fmi2/library.hpp"
#include "mebots/modeldesc/model_description.hpp"
#include "slave/slave.hpp"

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

/// The FMU under test. Only child processes call this FMU, through its C interface.
namespace mebots::check {

using modeldesc::ModelDescription;
using modeldesc::Variable;

/// The data that all probes use. They are complete before any code of the FMU runs.
struct Target {
  const ModelDescription* model;
  std::filesystem::path folder;
  std::filesystem::path library;
  double step_s;                       ///< step size of the default experiment, or 0.01 s
  int steps;                           ///< number of steps in a probe
  master::Experiment experiment = {};  ///< arguments of fmi2SetupExperiment, as in a run

  /// Returns the end time of a plain run.
  std::int64_t end_ns() const { return std::llround(step_s * steps * 1e9); }
};

/// Thrown if the FMU rejects a call that it must accept. The text contains the call, its status and the FMU's log.
class Refused : public Error {
 public:
  using Error::Error;
};

/// The outputs at one time, except OSMP binaries, which are addresses.
struct Outputs {
  std::vector<double> reals;
  std::vector<std::int32_t> integers;  // also enumerations
  std::vector<std::int32_t> booleans;
  std::vector<std::string> strings;

  bool operator==(const Outputs&) const = default;
};

/// Detects changes that an FMU makes to the process: file mode mask, working directory, locale, limits, descriptors,
/// signal handlers and mask, timers, priority, affinity, and floating-point environment.
class Surroundings {
 public:
  /// Returns a description of each change to the process since construction or the last call. Reverts the changes if
  /// possible.
  std::vector<std::string> changes();

 private:
  master::FloatEnvironment floats_ = master::FloatEnvironment::now();
  std::optional<master::ProcessState> process_{std::in_place};
};

class Library {
 public:
  /// Throws Error if the library cannot be loaded.
  Library(const Target& target, Witness& witness);

  const Target& target() const { return *target_; }
  Witness& witness() const { return *witness_; }
  const fmi2::Functions& functions() const { return functions_; }
  std::string resource_uri() const;
  /// Returns the changes to the process that loading the library made. They were reverted if possible.
  const std::vector<std::string>& changes_at_load() const { return changes_at_load_; }

  /// Returns the output variables of a type, in the order of the vector in Outputs.
  const std::vector<const Variable*>& output_variables(modeldesc::Type type) const;
  /// Returns the first difference as text, such as "cell.voltage: 3.7 instead of 3.6". Returns an empty text if the
  /// outputs are equal.
  std::string difference(const Outputs& found, const Outputs& wanted) const;

 private:
  const Target* target_;
  Witness* witness_;
  fmi2::Functions functions_;
  std::vector<std::string> changes_at_load_;
  std::vector<const Variable*> reals_, integers_, booleans_, strings_;
};

/// An instance of the FMU, which the destructor frees. Reports each call to the witness, so that a crash report can
/// name it.
class Instance final : private master::CallbackListener {
 public:
  /// Throws Refused if instantiation fails.
  Instance(const Library& library, std::string name);
  ~Instance() override;
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;

  fmi2Component component() const { return component_; }
  const fmi2::Functions& functions() const { return library_->functions(); }
  /// Drops the instance without freeing it.
  void forget() { component_ = nullptr; }
  void free();

  void setup() { setup(library_->target().experiment); }
  void setup(const master::Experiment& experiment);
  void enter();
  void exit();
  /// Sets up the experiment, then enters and exits initialization mode.
  void start() { start(library_->target().experiment); }
  void start(const master::Experiment& experiment);
  /// Performs a step. Throws Refused if the FMU rejects the step. If the FMU discards the step and sets fmi2Terminated,
  /// ended() becomes true.
  void step(double point_s, double step_s);
  bool ended() const { return ended_; }
  /// Performs the steps from `from` to `to` - 1, counted from 0. Stops if the FMU ends the run.
  void run(int from, int to);
  Outputs outputs();
  void set_state(fmi2FMUstate state);
  void reset();
  /// Terminates the instance. No effect if the FMU has ended the run.
  void terminate();

  /// Throws Refused unless `status` of the call is fmi2OK or fmi2Warning.
  void require(const std::string& call, fmi2Status status) const;
  void doing(std::string_view call) const { library_->witness().doing(call); }
  std::string last_message() const { return messages_.empty() ? "" : messages_.back(); }

 private:
  void logged(master::LoggerCall call) override;
  void step_finished(int /*status*/) override {}

  const Library* library_;
  std::string name_;
  master::CallbackTarget target_;
  fmi2CallbackFunctions callbacks_;
  fmi2Component component_ = nullptr;
  std::vector<std::string> messages_;
  std::mutex mutex_;  // an FMU may log from its own threads
  bool ended_ = false;
  bool reported_environment_ = false;
  bool reported_name_ = false;
  bool reported_category_ = false;
};

}  // namespace mebots::check
