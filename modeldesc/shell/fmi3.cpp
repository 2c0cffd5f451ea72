// SPDX-License-Identifier: Apache-2.0
// The C functions of FMI 3.0: thin wrappers of the calls that all versions share. Functions that read and set values
// are in fmi3_values.cpp; functions that MEbots' FMUs do not support are in fmi3_not_offered.cpp.
#include "fmi3_calls.hpp"

#include <optional>
#include <string>

namespace mebots::shell {
namespace {

/// The functions, each with the states in which it may be called.
namespace call {
using namespace legal;
constexpr Function kSetDebugLogging{"fmi3SetDebugLogging", kAlive};
constexpr Function kEnterConfigurationMode{"fmi3EnterConfigurationMode", kInstantiated};
constexpr Function kExitConfigurationMode{"fmi3ExitConfigurationMode", kConfiguration};
constexpr Function kEnterInitializationMode{"fmi3EnterInitializationMode", kInstantiated};
constexpr Function kExitInitializationMode{"fmi3ExitInitializationMode", kInitialization};
constexpr Function kTerminate{"fmi3Terminate", kStepComplete | kStepFailed};
constexpr Function kReset{"fmi3Reset", kAlive};
constexpr Function kGetFmuState{"fmi3GetFMUState", kAlive};
constexpr Function kSetFmuState{"fmi3SetFMUState", kAlive};
constexpr Function kFreeFmuState{"fmi3FreeFMUState", kAlive};
constexpr Function kSerializedFmuStateSize{"fmi3SerializedFMUStateSize", kAlive};
constexpr Function kSerializeFmuState{"fmi3SerializeFMUState", kAlive};
constexpr Function kDeserializeFmuState{"fmi3DeserializeFMUState", kAlive};
constexpr Function kDoStep{"fmi3DoStep", kStepComplete};
}  // namespace call

fmi3Status to_fmi3(Status status) {
  return static_cast<fmi3Status>(status);
}

/// Doubles each '#' of a message, because a single '#' marks a value reference in FMI 3.0.
Logger::Sink sink_of(fmi3LogMessageCallback log_message, fmi3InstanceEnvironment environment) {
  if (log_message == nullptr) return {};
  return [=](Status status, const char* category, std::string_view message) {
    log_message(environment, to_fmi3(status), category, doubled(message, '#').c_str());
  };
}

/// Refuses to create an instance of a kind that MEbots' FMUs do not support. `kind` is its name in the message.
fmi3Instance refuse_kind(const char* function, fmi3String name, fmi3String token, std::string_view kind,
                         fmi3LogMessageCallback log_message, fmi3InstanceEnvironment environment) {
  return instantiate(
      {function, kFmi3, name == nullptr ? "" : name, token, false}, [&] { return sink_of(log_message, environment); },
      [&]() -> std::filesystem::path { throw Error(fmt::format("only co-simulation is offered, not {}", kind)); });
}

}  // namespace
}  // namespace mebots::shell

using mebots::Error;
using namespace mebots::shell;  // NOLINT(google-build-using-namespace): the functions below are the standard's, and
                                // global

/// Also calls prepare_library(), because every tool calls this function before it creates the first instance.
const char* fmi3GetVersion() {
  prepare_library();
  return "3.0";
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String instance_name, fmi3String instantiation_token,
                                         fmi3String resource_path, fmi3Boolean /*visible*/, fmi3Boolean logging_on,
                                         fmi3Boolean event_mode_used, fmi3Boolean /*early_return_allowed*/,
                                         const fmi3ValueReference /*intermediate_variables*/[],
                                         std::size_t intermediate_count, fmi3InstanceEnvironment environment,
                                         fmi3LogMessageCallback log_message,
                                         fmi3IntermediateUpdateCallback /*intermediate_update*/) {
  const std::string_view name = instance_name == nullptr ? "" : instance_name;
  return instantiate(
      {"fmi3InstantiateCoSimulation", kFmi3, name, instantiation_token, logging_on},
      [&] { return sink_of(log_message, environment); },
      [&]() -> std::filesystem::path {
        if (event_mode_used) not_offered("hasEventMode = false, so eventModeUsed must be false");
        if (intermediate_count != 0)
          not_offered("providesIntermediateUpdate = false, so nRequiredIntermediateVariables must be 0");
        return path_of_text(resource_path == nullptr ? "" : resource_path);
      });
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String instance_name, fmi3String instantiation_token,
                                          fmi3String /*resource_path*/, fmi3Boolean /*visible*/,
                                          fmi3Boolean /*logging_on*/, fmi3InstanceEnvironment environment,
                                          fmi3LogMessageCallback log_message) {
  return refuse_kind("fmi3InstantiateModelExchange", instance_name, instantiation_token, "model exchange", log_message,
                     environment);
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String instance_name, fmi3String instantiation_token,
                                               fmi3String /*resource_path*/, fmi3Boolean /*visible*/,
                                               fmi3Boolean /*logging_on*/, fmi3InstanceEnvironment environment,
                                               fmi3LogMessageCallback log_message,
                                               fmi3ClockUpdateCallback /*clock_update*/,
                                               fmi3LockPreemptionCallback /*lock_preemption*/,
                                               fmi3UnlockPreemptionCallback /*unlock_preemption*/) {
  return refuse_kind("fmi3InstantiateScheduledExecution", instance_name, instantiation_token, "scheduled execution",
                     log_message, environment);
}

void fmi3FreeInstance(fmi3Instance instance) {
  free_instance(instance);
}

fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean logging_on, std::size_t category_count,
                               const fmi3String categories[]) {
  return guarded3(instance, call::kSetDebugLogging, [&](Instance& own) {
    own.logger().set_logging(logging_on, checked_array(categories, category_count, "categories"));
  });
}

fmi3Status fmi3EnterConfigurationMode(fmi3Instance instance) {
  return guarded3(instance, call::kEnterConfigurationMode, [](Instance& own) { own.enter_configuration(); });
}

fmi3Status fmi3ExitConfigurationMode(fmi3Instance instance) {
  return guarded3(instance, call::kExitConfigurationMode, [](Instance& own) { own.exit_configuration(); });
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean /*tolerance_defined*/,
                                       fmi3Float64 /*tolerance*/, fmi3Float64 start_time, fmi3Boolean stop_time_defined,
                                       fmi3Float64 stop_time) {
  return guarded3(instance, call::kEnterInitializationMode, [&](Instance& own) {
    own.setup_experiment(start_time, stop_time_defined ? std::optional(stop_time) : std::nullopt);
    own.enter_initialization();
  });
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance instance) {
  return guarded3(instance, call::kExitInitializationMode, [](Instance& own) { own.exit_initialization(); });
}

fmi3Status fmi3Terminate(fmi3Instance instance) {
  return guarded3(instance, call::kTerminate, [](Instance& own) { own.terminate(); });
}

fmi3Status fmi3Reset(fmi3Instance instance) {
  return guarded3(instance, call::kReset, [](Instance& own) { own.reset(); });
}

fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState* state) {
  return to_fmi3(get_state(instance, call::kGetFmuState, state));
}

fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState state) {
  return to_fmi3(set_state(instance, call::kSetFmuState, state));
}

fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState* state) {
  return to_fmi3(free_state(instance, call::kFreeFmuState, state));
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState state, std::size_t* size) {
  return to_fmi3(serialized_size(instance, call::kSerializedFmuStateSize, state, size));
}

fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState state, fmi3Byte bytes[], std::size_t size) {
  return to_fmi3(serialize_state(instance, call::kSerializeFmuState, state, bytes, size));
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte bytes[], std::size_t size,
                                   fmi3FMUState* state) {
  return to_fmi3(deserialize_state(instance, call::kDeserializeFmuState, bytes, size, state));
}

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 current_point, fmi3Float64 step_size,
                      fmi3Boolean /*no_set_state_before_current_point*/, fmi3Boolean* event_handling_needed,
                      fmi3Boolean* terminate_simulation, fmi3Boolean* early_return, fmi3Float64* last_successful_time) {
  return guarded3(instance, call::kDoStep, [&](Instance& own) {
    checked(event_handling_needed, "eventHandlingNeeded") = false;
    checked(terminate_simulation, "terminateSimulation") = false;
    checked(early_return, "earlyReturn") = false;
    checked(last_successful_time, "lastSuccessfulTime") = own.time_s();
    own.do_step(current_point, step_size);
    *last_successful_time = own.time_s();
  });
}
