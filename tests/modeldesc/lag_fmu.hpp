// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/fmi2/functions.hpp"
#include "mebots/modeldesc/archive.hpp"
#include "mebots/modeldesc/xml.hpp"

#include <cstdarg>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

/// The test FMU as an importing tool sees it: unpacked, loaded with dlopen, called through C.
namespace mebots::test {

/// Function pointers of the loaded library, all found by name.
struct Library {
  decltype(&fmi2GetTypesPlatform) get_types_platform;
  decltype(&fmi2GetVersion) get_version;
  decltype(&fmi2SetDebugLogging) set_debug_logging;
  decltype(&fmi2Instantiate) instantiate;
  decltype(&fmi2FreeInstance) free_instance;
  decltype(&fmi2SetupExperiment) setup_experiment;
  decltype(&fmi2EnterInitializationMode) enter_initialization_mode;
  decltype(&fmi2ExitInitializationMode) exit_initialization_mode;
  decltype(&fmi2Terminate) terminate;
  decltype(&fmi2Reset) reset;
  decltype(&fmi2GetReal) get_real;
  decltype(&fmi2GetInteger) get_integer;
  decltype(&fmi2GetBoolean) get_boolean;
  decltype(&fmi2GetString) get_string;
  decltype(&fmi2SetReal) set_real;
  decltype(&fmi2SetInteger) set_integer;
  decltype(&fmi2SetBoolean) set_boolean;
  decltype(&fmi2SetString) set_string;
  decltype(&fmi2GetFMUstate) get_fmu_state;
  decltype(&fmi2SetFMUstate) set_fmu_state;
  decltype(&fmi2FreeFMUstate) free_fmu_state;
  decltype(&fmi2SerializedFMUstateSize) serialized_fmu_state_size;
  decltype(&fmi2SerializeFMUstate) serialize_fmu_state;
  decltype(&fmi2DeSerializeFMUstate) deserialize_fmu_state;
  decltype(&fmi2GetDirectionalDerivative) get_directional_derivative;
  decltype(&fmi2SetRealInputDerivatives) set_real_input_derivatives;
  decltype(&fmi2GetRealOutputDerivatives) get_real_output_derivatives;
  decltype(&fmi2DoStep) do_step;
  decltype(&fmi2CancelStep) cancel_step;
  decltype(&fmi2GetStatus) get_status;
  decltype(&fmi2GetRealStatus) get_real_status;
  decltype(&fmi2GetIntegerStatus) get_integer_status;
  decltype(&fmi2GetBooleanStatus) get_boolean_status;
  decltype(&fmi2GetStringStatus) get_string_status;
};

/// Unpacked once per process, into a folder with a space and an umlaut in its name.
class LagFmu {
 public:
  static const LagFmu& get();

  const Library& library() const { return library_; }
  const modeldesc::ModelDescription& description() const { return description_; }
  std::filesystem::path binary() const;
  /// `resources/` as a file: URI with percent-encoding.
  std::string resource_uri() const;
  fmi2ValueReference reference(std::string_view name) const;

 private:
  LagFmu();

  modeldesc::TemporaryFolder folder_;
  modeldesc::ModelDescription description_;
  Library library_{};
};

struct Message {
  std::string instance;
  fmi2Status status;
  std::string category;
  std::string text;
};

/// One instance with the messages it sent.
class Lag {
 public:
  explicit Lag(const std::string& name = "lag", bool logging_on = false);
  ~Lag();
  Lag(const Lag&) = delete;
  Lag& operator=(const Lag&) = delete;

  fmi2Component component() const { return component_; }
  const std::vector<Message>& messages() const { return messages_; }
  /// Text of the last message, or "".
  std::string last_message() const { return messages_.empty() ? "" : messages_.back().text; }

  /// Setup, enter and exit: ready to step.
  void start(double start_s = 0);
  fmi2Status step(double point_s, double step_s);

  fmi2Status set(std::string_view name, double value);
  fmi2Status set_integer(std::string_view name, fmi2Integer value);
  fmi2Status set_boolean(std::string_view name, fmi2Boolean value);
  fmi2Status set_string(std::string_view name, const char* value);
  double real(std::string_view name);
  fmi2Integer integer(std::string_view name);
  bool boolean(std::string_view name);
  std::string string(std::string_view name);

  fmi2FMUstate save();
  std::vector<char> serialized();

  static void log(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status, fmi2String category,
                  fmi2String format, ...);
  /// Callbacks whose messages land in `messages`.
  static fmi2CallbackFunctions callbacks(std::vector<Message>& messages);

 private:
  std::vector<Message> messages_;
  fmi2CallbackFunctions callbacks_;
  fmi2Component component_;
};

}  // namespace mebots::test
