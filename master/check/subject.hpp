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

/// Declares the FMU under test. The FMU is called through its C interface, as in an importing tool, and only in a child
/// process.
namespace mebots::check {

using modeldesc::ModelDescription;
using modeldesc::Variable;

/// The data that all probes use. The data are complete before any code of the FMU runs.
struct Target {
  const ModelDescription* model;
  std::filesystem::path folder;        ///< the unpacked FMU
  std::filesystem::path library;       ///< its shared library
  double step_s;                       ///< step size of the default experiment, or 0.01 s
  int steps;                           ///< number of steps in a probe
  master::Experiment experiment = {};  ///< the same arguments of fmi2SetupExperiment as in a run

  /// Returns the time at which a plain run ends.
  std::int64_t end_ns() const { return std::llround(step_s * steps * 1e9); }
};

/// Thrown if the FMU rejects a call that it must accept. The message contains the call, its status and the FMU's log.
class Refused : public Error {
 public:
  using Error::Error;
};

/// The values of all outputs at one time. Parts of OSMP binaries are left out, because they are addresses.
struct Outputs {
  std::vector<double> reals;
  std::vector<std::int32_t> integers;  // also contains enumerations
  std::vector<std::int32_t> booleans;
  std::vector<std::string> strings;

  bool operator==(const Outputs&) const = default;
};

/// Detects changes of process-wide state that the FMU can make. This state consists of the file mode mask, working
/// directory, locale, limits, descriptors, signal handlers and mask, timers, priority, affinity, and the floating-point
/// environment.
class Surroundings {
 public:
  /// Returns descriptions of the changes since construction or the last call. Reverts all changes that can be reverted.
  std::vector<std::string> changes();

 private:
  master::FloatEnvironment floats_ = master::FloatEnvironment::now();
  std::optional<master::ProcessState> process_{std::in_place};
};

/// The FMU's shared library after loading.
class Library {
 public:
  /// Throws Error if the library cannot be loaded.
  Library(const Target& target, Witness& witness);

  const Target& target() const { return *target_; }
  Witness& witness() const { return *witness_; }
  const fmi2::Functions& functions() const { return functions_; }
  std::string resource_uri() const;
  /// Returns the changes that the library made to the process while it was loaded. These changes were reverted.
  const std::vector<std::string>& changes_at_load() const { return changes_at_load_; }

  /// Returns the output variables of a type, in the order of the corresponding member of Outputs, such as
  /// Outputs::reals.
  const std::vector<const Variable*>& output_variables(modeldesc::Type type) const;
  /// Returns the first difference as text, such as "cell.voltage: 3.7 instead of 3.6". Returns an empty text if there
  /// is no difference.
  std::string difference(const Outputs& found, const Outputs& wanted) const;

 private:
  const Target* target_;
  Witness* witness_;
  fmi2::Functions functions_;
  std::vector<std::string> changes_at_load_;
  std::vector<const Variable*> reals_, integers_, booleans_, strings_;
};

/// An instance of the FMU. The destructor frees the instance. Before each call to the FMU, reports the call's name to
/// the witness.
class Instance final : private master::CallbackListener {
 public:
  /// Throws Refused if instantiation fails.
  Instance(const Library& library, std::string name);
  ~Instance() override;
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;

  fmi2Component component() const { return component_; }
  const fmi2::Functions& functions() const { return library_->functions(); }
  /// Drops the instance, so that the destructor does not free it.
  void forget() { component_ = nullptr; }
  void free();

  void setup() { setup(library_->target().experiment); }
  void setup(const master::Experiment& experiment);
  void enter();
  void exit();
  /// Sets up the experiment, and enters and exits initialization mode.
  void start() { start(library_->target().experiment); }
  void start(const master::Experiment& experiment);
  /// Performs a step. Throws Refused if the FMU rejects the step. If the FMU returns fmi2Discard and sets
  /// fmi2Terminated, ended() becomes true.
  void step(double point_s, double step_s);
  bool ended() const { return ended_; }
  /// Performs the steps `from` to `to` - 1, counted from 0. Stops early if the FMU ends the run.
  void run(int from, int to);
  Outputs outputs();
  void set_state(fmi2FMUstate state);
  void reset();
  /// Terminates the instance. Has no effect if the FMU has ended the run.
  void terminate();

  /// Throws Refused unless `status`, which the FMU returned for `call`, is fmi2OK or fmi2Warning.
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
  std::mutex mutex_;  // protects members from the FMU's own threads, which may log
  bool ended_ = false;
  bool reported_environment_ = false;
  bool reported_name_ = false;
  bool reported_category_ = false;
};

}  // namespace mebots::check
