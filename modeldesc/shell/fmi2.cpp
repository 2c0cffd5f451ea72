// SPDX-License-Identifier: Apache-2.0
// The C functions of FMI 2.0: thin wrappers of the calls that all versions share.
#include "calls.hpp"
#include "mebots/fmi2/functions.hpp"

namespace mebots::shell {
namespace {

/// The functions, each with the states in which it may be called.
namespace call {
using namespace legal;
constexpr std::uint8_t kStatus = kStepComplete | kStepFailed | kTerminated;
constexpr Function kSetDebugLogging{"fmi2SetDebugLogging", kAlive};
constexpr Function kSetupExperiment{"fmi2SetupExperiment", kInstantiated};
constexpr Function kEnterInitializationMode{"fmi2EnterInitializationMode", kInstantiated};
constexpr Function kExitInitializationMode{"fmi2ExitInitializationMode", kInitialization};
constexpr Function kTerminate{"fmi2Terminate", kStepComplete | kStepFailed};
constexpr Function kReset{"fmi2Reset", kAlive};
constexpr Function kGetReal{"fmi2GetReal", kInitialization | kAfterInitialization};
constexpr Function kGetInteger{"fmi2GetInteger", kInitialization | kAfterInitialization};
constexpr Function kGetBoolean{"fmi2GetBoolean", kInitialization | kAfterInitialization};
constexpr Function kGetString{"fmi2GetString", kInitialization | kAfterInitialization};
constexpr Function kSetReal{"fmi2SetReal", kInstantiated | kInitialization | kStepComplete};
constexpr Function kSetInteger{"fmi2SetInteger", kInstantiated | kInitialization | kStepComplete};
constexpr Function kSetBoolean{"fmi2SetBoolean", kInstantiated | kInitialization | kStepComplete};
constexpr Function kSetString{"fmi2SetString", kInstantiated | kInitialization | kStepComplete};
constexpr Function kGetFmuState{"fmi2GetFMUstate", kAlive};
constexpr Function kSetFmuState{"fmi2SetFMUstate", kAlive};
constexpr Function kFreeFmuState{"fmi2FreeFMUstate", kAlive};
constexpr Function kSerializedFmuStateSize{"fmi2SerializedFMUstateSize", kAlive};
constexpr Function kSerializeFmuState{"fmi2SerializeFMUstate", kAlive};
constexpr Function kDeSerializeFmuState{"fmi2DeSerializeFMUstate", kAlive};
constexpr Function kGetDirectionalDerivative{"fmi2GetDirectionalDerivative", kInitialization | kAfterInitialization};
constexpr Function kSetRealInputDerivatives{"fmi2SetRealInputDerivatives",
                                            kInstantiated | kInitialization | kStepComplete};
constexpr Function kGetRealOutputDerivatives{"fmi2GetRealOutputDerivatives", kAfterInitialization};
constexpr Function kDoStep{"fmi2DoStep", kStepComplete};
constexpr Function kCancelStep{"fmi2CancelStep", 0};
constexpr Function kGetStatus{"fmi2GetStatus", kStatus};
constexpr Function kGetRealStatus{"fmi2GetRealStatus", kStatus};
constexpr Function kGetIntegerStatus{"fmi2GetIntegerStatus", kStatus};
constexpr Function kGetBooleanStatus{"fmi2GetBooleanStatus", kStatus};
constexpr Function kGetStringStatus{"fmi2GetStringStatus", kStatus};
}  // namespace call

static_assert(static_cast<int>(Status::ok) == fmi2OK && static_cast<int>(Status::warning) == fmi2Warning &&
              static_cast<int>(Status::discard) == fmi2Discard && static_cast<int>(Status::error) == fmi2Error &&
              static_cast<int>(Status::fatal) == fmi2Fatal);

fmi2Status to_fmi2(Status status) {
  return static_cast<fmi2Status>(status);
}

template <typename Body>
fmi2Status guarded2(fmi2Component component, const Function& function, Body body) noexcept {
  return to_fmi2(guarded(component, function, body));
}

/// Doubles each '%' of a message, because the tool treats the message as a printf format.
Logger::Sink sink_of(const fmi2CallbackFunctions& callbacks, std::string name) {
  if (callbacks.logger == nullptr) return {};
  return [logger = callbacks.logger, environment = callbacks.componentEnvironment, name = std::move(name)](
             Status status, const char* category, std::string_view message) {
    logger(environment, name.c_str(), to_fmi2(status), category, doubled(message, '%').c_str());
  };
}

}  // namespace
}  // namespace mebots::shell

using mebots::Error;
using namespace mebots::shell;  // NOLINT(google-build-using-namespace): the functions below are the standard's, and
                                // global

/// Also calls prepare_library(), because every tool calls this function before it creates the first instance.
const char* fmi2GetTypesPlatform() {
  prepare_library();
  return "default";
}

const char* fmi2GetVersion() {
  return "2.0";
}

fmi2Component fmi2Instantiate(fmi2String instance_name, fmi2Type type, fmi2String guid, fmi2String resource_location,
                              const fmi2CallbackFunctions* functions, fmi2Boolean /*visible*/, fmi2Boolean logging_on) {
  if (functions == nullptr) return nullptr;
  const std::string_view name = instance_name == nullptr ? "" : instance_name;
  return instantiate(
      {"fmi2Instantiate", kFmi2, name, guid, logging_on != fmi2False},
      [&] { return sink_of(*functions, std::string(name)); },
      [&] {
        if (type != fmi2CoSimulation) throw Error("only co-simulation is offered, not model exchange");
        return path_of_file_uri(resource_location == nullptr ? "" : resource_location);
      });
}

void fmi2FreeInstance(fmi2Component component) {
  free_instance(component);
}

fmi2Status fmi2SetDebugLogging(fmi2Component component, fmi2Boolean logging_on, std::size_t category_count,
                               const fmi2String categories[]) {
  return guarded2(component, call::kSetDebugLogging, [&](Instance& instance) {
    instance.logger().set_logging(logging_on != fmi2False, checked_array(categories, category_count, "categories"));
  });
}

fmi2Status fmi2SetupExperiment(fmi2Component component, fmi2Boolean /*tolerance_defined*/, fmi2Real /*tolerance*/,
                               fmi2Real start_time, fmi2Boolean stop_time_defined, fmi2Real stop_time) {
  return guarded2(component, call::kSetupExperiment, [&](Instance& instance) {
    instance.setup_experiment(start_time, stop_time_defined != fmi2False ? std::optional(stop_time) : std::nullopt);
  });
}

fmi2Status fmi2EnterInitializationMode(fmi2Component component) {
  return guarded2(component, call::kEnterInitializationMode,
                  [](Instance& instance) { instance.enter_initialization(); });
}

fmi2Status fmi2ExitInitializationMode(fmi2Component component) {
  return guarded2(component, call::kExitInitializationMode, [](Instance& instance) { instance.exit_initialization(); });
}

fmi2Status fmi2Terminate(fmi2Component component) {
  return guarded2(component, call::kTerminate, [](Instance& instance) { instance.terminate(); });
}

fmi2Status fmi2Reset(fmi2Component component) {
  return guarded2(component, call::kReset, [](Instance& instance) { instance.reset(); });
}

fmi2Status fmi2GetReal(fmi2Component component, const fmi2ValueReference references[], std::size_t count,
                       fmi2Real values[]) {
  return guarded2(component, call::kGetReal, [&](Instance& instance) {
    instance.get(checked_array(references, count, "vr"), checked_array(values, count, "value"));
  });
}

fmi2Status fmi2GetInteger(fmi2Component component, const fmi2ValueReference references[], std::size_t count,
                          fmi2Integer values[]) {
  return guarded2(component, call::kGetInteger, [&](Instance& instance) {
    instance.get(checked_array(references, count, "vr"), checked_array(values, count, "value"));
  });
}

fmi2Status fmi2GetBoolean(fmi2Component component, const fmi2ValueReference references[], std::size_t count,
                          fmi2Boolean values[]) {
  return guarded2(component, call::kGetBoolean, [&](Instance& instance) {
    instance.get_booleans(checked_array(references, count, "vr"), checked_array(values, count, "value"));
  });
}

fmi2Status fmi2GetString(fmi2Component component, const fmi2ValueReference references[], std::size_t count,
                         fmi2String values[]) {
  return guarded2(component, call::kGetString, [&](Instance& instance) {
    instance.get(checked_array(references, count, "vr"), checked_array(values, count, "value"));
  });
}

fmi2Status fmi2SetReal(fmi2Component component, const fmi2ValueReference references[], std::size_t count,
                       const fmi2Real values[]) {
  return guarded2(component, call::kSetReal, [&](Instance& instance) {
    instance.set(checked_array(references, count, "vr"), checked_array(values, count, "value"));
  });
}

fmi2Status fmi2SetInteger(fmi2Component component, const fmi2ValueReference references[], std::size_t count,
                          const fmi2Integer values[]) {
  return guarded2(component, call::kSetInteger, [&](Instance& instance) {
    instance.set(checked_array(references, count, "vr"), checked_array(values, count, "value"));
  });
}

fmi2Status fmi2SetBoolean(fmi2Component component, const fmi2ValueReference references[], std::size_t count,
                          const fmi2Boolean values[]) {
  return guarded2(component, call::kSetBoolean, [&](Instance& instance) {
    instance.set_booleans(checked_array(references, count, "vr"), checked_array(values, count, "value"));
  });
}

fmi2Status fmi2SetString(fmi2Component component, const fmi2ValueReference references[], std::size_t count,
                         const fmi2String values[]) {
  return guarded2(component, call::kSetString, [&](Instance& instance) {
    instance.set(checked_array(references, count, "vr"), checked_array(values, count, "value"));
  });
}

fmi2Status fmi2GetFMUstate(fmi2Component component, fmi2FMUstate* state) {
  return to_fmi2(get_state(component, call::kGetFmuState, state));
}

fmi2Status fmi2SetFMUstate(fmi2Component component, fmi2FMUstate state) {
  return to_fmi2(set_state(component, call::kSetFmuState, state));
}

fmi2Status fmi2FreeFMUstate(fmi2Component component, fmi2FMUstate* state) {
  return to_fmi2(free_state(component, call::kFreeFmuState, state));
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component component, fmi2FMUstate state, std::size_t* size) {
  return to_fmi2(serialized_size(component, call::kSerializedFmuStateSize, state, size));
}

fmi2Status fmi2SerializeFMUstate(fmi2Component component, fmi2FMUstate state, fmi2Byte bytes[], std::size_t size) {
  return to_fmi2(serialize_state(component, call::kSerializeFmuState, state, bytes, size));
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component component, const fmi2Byte bytes[], std::size_t size,
                                   fmi2FMUstate* state) {
  return to_fmi2(deserialize_state(component, call::kDeSerializeFmuState, bytes, size, state));
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component component, const fmi2ValueReference[], std::size_t,
                                        const fmi2ValueReference[], std::size_t, const fmi2Real[], fmi2Real[]) {
  return guarded2(component, call::kGetDirectionalDerivative,
                  [](Instance&) { not_offered("providesDirectionalDerivative = false"); });
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component component, const fmi2ValueReference[], std::size_t,
                                       const fmi2Integer[], const fmi2Real[]) {
  return guarded2(component, call::kSetRealInputDerivatives,
                  [](Instance&) { not_offered("canInterpolateInputs = false"); });
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component component, const fmi2ValueReference[], std::size_t,
                                        const fmi2Integer[], fmi2Real[]) {
  return guarded2(component, call::kGetRealOutputDerivatives,
                  [](Instance&) { not_offered("maxOutputDerivativeOrder = 0"); });
}

fmi2Status fmi2DoStep(fmi2Component component, fmi2Real current_point, fmi2Real step_size,
                      fmi2Boolean /*no_set_state_before_current_point*/) {
  return guarded2(component, call::kDoStep, [&](Instance& instance) { instance.do_step(current_point, step_size); });
}

fmi2Status fmi2CancelStep(fmi2Component component) {
  return guarded2(component, call::kCancelStep, [](Instance&) {});
}

fmi2Status fmi2GetStatus(fmi2Component component, fmi2StatusKind kind, fmi2Status* value) {
  return guarded2(component, call::kGetStatus, [&](Instance& instance) {
    if (kind != fmi2DoStepStatus)
      throw Error("only fmi2DoStepStatus is a status; use the function for the type of the requested value");
    checked(value, "value") = to_fmi2(instance.last_step_status());
  });
}

fmi2Status fmi2GetRealStatus(fmi2Component component, fmi2StatusKind kind, fmi2Real* value) {
  return guarded2(component, call::kGetRealStatus, [&](Instance& instance) {
    if (kind != fmi2LastSuccessfulTime)
      throw Error("only fmi2LastSuccessfulTime is a Real; use the function for the type of the requested value");
    checked(value, "value") = instance.time_s();
  });
}

fmi2Status fmi2GetIntegerStatus(fmi2Component component, fmi2StatusKind /*kind*/, fmi2Integer* /*value*/) {
  return guarded2(component, call::kGetIntegerStatus,
                  [](Instance&) { throw Error("FMI 2.0 defines no status that is an Integer"); });
}

fmi2Status fmi2GetBooleanStatus(fmi2Component component, fmi2StatusKind kind, fmi2Boolean* value) {
  return guarded2(component, call::kGetBooleanStatus, [&](Instance&) {
    if (kind != fmi2Terminated)
      throw Error("only fmi2Terminated is a Boolean; use the function for the type of the requested value");
    checked(value, "value") = fmi2False;  // this FMU never ends the simulation
  });
}

fmi2Status fmi2GetStringStatus(fmi2Component component, fmi2StatusKind kind, fmi2String* value) {
  return guarded2(component, call::kGetStringStatus, [&](Instance&) {
    if (kind != fmi2PendingStatus)
      throw Error("only fmi2PendingStatus is a String; use the function for the type of the requested value");
    checked(value, "value") = "";  // a step is never pending
  });
}
