// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/error.hpp"
#include "mebots/modeldesc/model_description.hpp"
#include "model/run_course.hpp"
#include "model/value_kind.hpp"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace mebots::master {

/// Thrown if a call to an FMU fails. The message contains instance, time, function, status and the FMU's log.
class SlaveError : public Error {
 public:
  explicit SlaveError(const std::string& text) : SlaveError(ErrorCode::fmu_failed, text) {}
  SlaveError(ErrorCode code, const std::string& text) : Error(code, text) {}
};

/// Thrown if an FMU returns NaN or infinity for one of its variables.
class NotFiniteError : public SlaveError {
 public:
  explicit NotFiniteError(const std::string& text) : SlaveError(ErrorCode::not_finite, text) {}
};

/// Describes how a step ended.
struct StepResult {
  bool done = true;
  bool pending = false;     ///< the step is not done yet; the FMU continues in the background, see Slave::finish_step()
  bool cancelled = false;   ///< the step is not done, because the master cancelled a pending step
  bool terminated = false;  ///< the step is not done, because the FMU requested the end of the simulation
  /// If the step is not done: the time that the FMU has reached, if it reports one.
  std::optional<double> last_successful_s;
  std::string messages;  ///< if the step is not done: the FMU's log messages about it
};

/// The state of a slave at one moment. The slave stores the data; therefore this object must not outlive the slave.
class SlaveState {
 public:
  virtual ~SlaveState() = default;
};

/// An instance of an FMU in this or another process. The calls must have this order: set start values;
/// setup_experiment(); enter_initialization(); get and set outputs and inputs; exit_initialization(); any number of set
/// inputs, step(), get outputs; terminate(). Every call throws SlaveError if the FMU rejects it. Afterwards, the slave
/// must only be destroyed. Spans of references and values must have the same length. Must not be used by two threads at
/// the same time.
class Slave {
 public:
  virtual ~Slave() = default;

  virtual const std::string& name() const = 0;
  virtual const modeldesc::ModelDescription& description() const = 0;

  virtual void setup_experiment(const Experiment& experiment) = 0;
  virtual void enter_initialization() = 0;
  virtual void exit_initialization() = 0;
  virtual StepResult step(std::int64_t start_ns, std::int64_t duration_ns) = 0;
  /// Waits for the end of a step that step() has left pending. If `cancel` becomes true, cancels the step
  /// (fmi2CancelStep). After a cancelled step, the slave may only be read, terminated and destroyed.
  virtual StepResult finish_step(const std::atomic<bool>& cancel);
  virtual void terminate() = 0;
  /// Frees the instance. No call may follow. The destructor frees the instance if this function was not called. If
  /// freeing fails, logs the error and returns it. This error does not affect the results.
  virtual std::optional<std::string> free_instance() = 0;

  virtual void get_reals(std::span<const ValueReference> references, std::span<double> values) = 0;
  /// Gets the values of Integers and enumerations.
  virtual void get_integers(std::span<const ValueReference> references, std::span<std::int64_t> values) = 0;
  /// Gets the values of Booleans as 0 or 1, even if the FMU uses another number for true.
  virtual void get_booleans(std::span<const ValueReference> references, std::span<std::int64_t> values) = 0;
  /// Gets the values of Strings as bytes, which need not be UTF-8.
  virtual void get_strings(std::span<const ValueReference> references, std::span<std::string> values) = 0;
  /// Gets the values of Binaries (FMI 3.0). Slaves of other FMI versions throw Error.
  virtual void get_binaries(std::span<const ValueReference> references, std::span<std::string> values);

  virtual void set_reals(std::span<const ValueReference> references, std::span<const double> values) = 0;
  virtual void set_integers(std::span<const ValueReference> references, std::span<const std::int64_t> values) = 0;
  /// Each value must be 0 or 1.
  virtual void set_booleans(std::span<const ValueReference> references, std::span<const std::int64_t> values) = 0;
  virtual void set_strings(std::span<const ValueReference> references, std::span<const std::string> values) = 0;
  virtual void set_binaries(std::span<const ValueReference> references, std::span<const std::string> values);

  /// Returns the highest order of output derivatives that the FMU provides. Returns 0 if it provides none.
  virtual std::uint32_t output_derivative_order() const { return 0; }
  /// True if the FMU uses time derivatives of its inputs.
  virtual bool takes_input_derivatives() const { return false; }
  /// Returns the time of the next known event, such as the tick of a clock [s]. Returns nullopt if no event is known.
  /// Other instances see the changes of the event from the next communication point.
  virtual std::optional<double> next_event_s() const { return std::nullopt; }
  /// Returns notices for the user about the process in which this instance runs, such as a missing mechanism of its
  /// sandbox.
  virtual std::vector<std::string> notices() const { return {}; }
  /// Gets derivatives of Real outputs at the end of the last step. `orders` contains the order, from 1, for each
  /// reference. The values are not checked and may be NaN.
  virtual void get_output_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                                      std::span<double> values);
  /// Sets derivatives of Real inputs at the start of the next step. `orders` contains the order, from 1, for each
  /// reference.
  virtual void set_input_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                                     std::span<const double> values);

  /// Saves the state of the instance. Throws Error if the FMU cannot save it (canGetAndSetFMUstate is false). While a
  /// saved state exists, every step passes noSetFMUStatePriorToCurrentPoint = false to the FMU, because the FMU may
  /// return to an earlier time.
  virtual std::unique_ptr<SlaveState> save_state() = 0;
  /// Restores a saved state. Throws Error if a step was performed since then while no saved state existed.
  virtual void restore_state(const SlaveState& state) = 0;
  /// Converts a saved state to bytes. Throws Error if the FMU cannot do this (canSerializeFMUstate is false).
  virtual std::vector<std::byte> serialize(const SlaveState& state) = 0;
  virtual std::unique_ptr<SlaveState> deserialize(std::span<const std::byte> bytes) = 0;
};

}  // namespace mebots::master
