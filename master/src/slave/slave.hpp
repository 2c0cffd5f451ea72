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

struct StepResult {
  bool done = true;
  bool pending = false;     ///< the FMU continues the step in the background, see Slave::finish_step()
  bool cancelled = false;   ///< the master cancelled a pending step
  bool terminated = false;  ///< the FMU requested the end of the simulation
  /// Time that the FMU has reached in an incomplete step, if it reports the time.
  std::optional<double> last_successful_s;
  std::string messages;  ///< log messages of the FMU about an incomplete step
};

/// A saved state of a slave. Must not outlive the slave, which stores the data.
class SlaveState {
 public:
  virtual ~SlaveState() = default;
};

/// An instance of an FMU in this or another process. The calls must have this order: set start values;
/// setup_experiment(); enter_initialization(); get outputs and set inputs; exit_initialization(); any number of: set
/// inputs, step(), get outputs; terminate().
///
/// All functions throw SlaveError if the call to the FMU fails. The slave must then only be destroyed. `references` and
/// `values` must have the same length. Must not be used by two threads at the same time.
class Slave {
 public:
  virtual ~Slave() = default;

  virtual const std::string& name() const = 0;
  virtual const modeldesc::ModelDescription& description() const = 0;

  virtual void setup_experiment(const Experiment& experiment) = 0;
  virtual void enter_initialization() = 0;
  virtual void exit_initialization() = 0;
  virtual StepResult step(std::int64_t start_ns, std::int64_t duration_ns) = 0;
  /// Waits for the end of a pending step. If `cancel` becomes true, cancels the step (fmi2CancelStep). After that, the
  /// slave may only be read, terminated and destroyed.
  virtual StepResult finish_step(const std::atomic<bool>& cancel);
  virtual void terminate() = 0;
  /// Frees the instance. Must be the last call. The destructor calls it if necessary. If the FMU fails, logs the error
  /// and returns it. The error does not affect the results.
  virtual std::optional<std::string> free_instance() = 0;

  virtual void get_reals(std::span<const ValueReference> references, std::span<double> values) = 0;
  /// Gets Integers and enumerations.
  virtual void get_integers(std::span<const ValueReference> references, std::span<std::int64_t> values) = 0;
  /// Gets Booleans as 0 or 1, even if the FMU uses another number for true.
  virtual void get_booleans(std::span<const ValueReference> references, std::span<std::int64_t> values) = 0;
  /// Gets Strings as bytes, which need not be UTF-8.
  virtual void get_strings(std::span<const ValueReference> references, std::span<std::string> values) = 0;
  /// Gets Binaries (FMI 3.0). Throws Error in other versions of FMI.
  virtual void get_binaries(std::span<const ValueReference> references, std::span<std::string> values);

  virtual void set_reals(std::span<const ValueReference> references, std::span<const double> values) = 0;
  virtual void set_integers(std::span<const ValueReference> references, std::span<const std::int64_t> values) = 0;
  /// `values` must contain only 0 and 1.
  virtual void set_booleans(std::span<const ValueReference> references, std::span<const std::int64_t> values) = 0;
  virtual void set_strings(std::span<const ValueReference> references, std::span<const std::string> values) = 0;
  virtual void set_binaries(std::span<const ValueReference> references, std::span<const std::string> values);

  /// Returns the highest order of the output derivatives that the FMU provides; 0 if it provides none.
  virtual std::uint32_t output_derivative_order() const { return 0; }
  /// True if the FMU uses time derivatives of its inputs.
  virtual bool takes_input_derivatives() const { return false; }
  /// Returns the time in seconds of the next event, such as a clock tick; nullopt if no event is known. Other instances
  /// receive the changed outputs at the next communication point.
  virtual std::optional<double> next_event_s() const { return std::nullopt; }
  /// Returns notices for the user about the process of this instance, such as a missing mechanism of its sandbox.
  virtual std::vector<std::string> notices() const { return {}; }
  /// Gets derivatives of Real outputs at the end of the last step. `orders` contains the order of each derivative, from
  /// 1. The values may be NaN.
  virtual void get_output_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                                      std::span<double> values);
  /// Sets derivatives of Real inputs at the start of the next step. `orders` contains the order of each derivative,
  /// from 1.
  virtual void set_input_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                                     std::span<const double> values);

  /// Saves the state of the instance. Throws Error if the FMU cannot save its state (canGetAndSetFMUstate = false).
  /// While a saved state exists, steps pass noSetFMUStatePriorToCurrentPoint = false to the FMU.
  virtual std::unique_ptr<SlaveState> save_state() = 0;
  /// Restores a saved state. Throws Error if a step was performed since then while no saved state existed.
  virtual void restore_state(const SlaveState& state) = 0;
  /// Converts a saved state to bytes. Throws Error if the FMU cannot do this (canSerializeFMUstate = false).
  virtual std::vector<std::byte> serialize(const SlaveState& state) = 0;
  virtual std::unique_ptr<SlaveState> deserialize(std::span<const std::byte> bytes) = 0;
};

}  // namespace mebots::master
