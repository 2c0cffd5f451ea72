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

/// The FMU under test, called through C as an importing tool calls it. Only inside a child process.
namespace mebots::check {

using modeldesc::ModelDescription;
using modeldesc::Variable;

/// What the probes know before any of the FMU's code runs.
struct Target {
  const ModelDescription* model;
  std::filesystem::path folder;        ///< the unpacked FMU
  std::filesystem::path library;       ///< its shared library
  double step_s;                       ///< of the default experiment, or 0.01 s
  int steps;                           ///< how many steps a probe takes
  master::Experiment experiment = {};  ///< arguments of fmi2SetupExperiment, as a run passes them

  /// The end of a plain run.
  std::int64_t end_ns() const { return std::llround(step_s * steps * 1e9); }
};

/// The FMU refused something that it must do. The text names call, status and what the FMU logged.
class Refused : public Error {
 public:
  using Error::Error;
};

/// Values of all outputs at one moment. Parts of OSMP binaries, which are addresses, are left out.
struct Outputs {
  std::vector<double> reals;
  std::vector<std::int32_t> integers;  // enumerations too
  std::vector<std::int32_t> booleans;
  std::vector<std::string> strings;

  bool operator==(const Outputs&) const = default;
};

/// What the FMU changes for everybody in its process: file mode mask, working directory, locale, limits, descriptors,
/// signal handlers and mask, timers, priority, affinity, and how the thread computes.
class Surroundings {
 public:
  /// What changed since this was made or asked last; put right as far as may be.
  std::vector<std::string> changes();

 private:
  master::FloatEnvironment floats_ = master::FloatEnvironment::now();
  std::optional<master::ProcessState> process_{std::in_place};
};

/// The loaded library.
class Library {
 public:
  /// Throws Error when the loader refuses it.
  Library(const Target& target, Witness& witness);

  const Target& target() const { return *target_; }
  Witness& witness() const { return *witness_; }
  const fmi2::Functions& functions() const { return functions_; }
  std::string resource_uri() const;
  /// What loading changed for the whole process, and was put right.
  const std::vector<std::string>& changes_at_load() const { return changes_at_load_; }

  /// Variables of the outputs in the order of Outputs::reals and so on.
  const std::vector<const Variable*>& output_variables(modeldesc::Type type) const;
  /// "cell.voltage: 3.7 instead of 3.6", the first difference; empty when there is none.
  std::string difference(const Outputs& found, const Outputs& wanted) const;

 private:
  const Target* target_;
  Witness* witness_;
  fmi2::Functions functions_;
  std::vector<std::string> changes_at_load_;
  std::vector<const Variable*> reals_, integers_, booleans_, strings_;
};

/// One instance; freed at the end of its life. Every call names itself to the witness before it is made.
class Instance final : private master::CallbackListener {
 public:
  /// Throws Refused when the FMU gives no instance.
  Instance(const Library& library, std::string name);
  ~Instance() override;
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;

  fmi2Component component() const { return component_; }
  const fmi2::Functions& functions() const { return library_->functions(); }
  /// Gives the instance up without freeing it.
  void forget() { component_ = nullptr; }
  void free();

  void setup() { setup(library_->target().experiment); }
  void setup(const master::Experiment& experiment);
  void enter();
  void exit();
  /// setup, enter, exit.
  void start() { start(library_->target().experiment); }
  void start(const master::Experiment& experiment);
  /// Throws Refused unless it is taken, or the FMU ends the run: fmi2Discard, and fmi2Terminated is true.
  void step(double point_s, double step_s);
  bool ended() const { return ended_; }
  /// Steps from step `from` to step `to` of the target's step; to the end, if the FMU ends the run before.
  void run(int from, int to);
  Outputs outputs();
  void set_state(fmi2FMUstate state);
  void reset();
  /// Nothing for a run that the FMU ended.
  void terminate();

  /// Names the call to the witness, makes it, throws Refused unless it answers fmi2OK or fmi2Warning.
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
  std::mutex mutex_;  // the FMU may log from threads of its own
  bool ended_ = false;
  bool reported_environment_ = false;
  bool reported_name_ = false;
  bool reported_category_ = false;
};

}  // namespace mebots::check
