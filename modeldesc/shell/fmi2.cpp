// SPDX-License-Identifier: Apache-2.0
// The C functions of FMI 2.0. Each finds its instance, checks that the call is legal now, and lets no exception out.
#include "instance.hpp"
#include "mebots/error.hpp"
#include "mebots/fmi2/functions.hpp"

#include <fmt/format.h>

#include <cstring>
#include <exception>
#include <locale>
#include <memory>
#include <new>

namespace {

using mebots::Error;
using mebots::shell::Function;
using mebots::shell::Instance;
using mebots::shell::Logger;
using mebots::shell::SavedState;
using mebots::shell::State;
namespace function = mebots::shell::function;

/// Never throws: a tool that refuses the message must not keep us from returning the status.
void report(Instance& instance, fmi2Status status, const Function& function, const char* what) noexcept {
  try {
    const char* category = status == fmi2Fatal ? "logStatusFatal" : "logStatusError";
    instance.logger().log(status, category, fmt::format("{}: {}", function.name, what));
  } catch (...) {  // NOLINT(bugprone-empty-catch): no memory left to say so
  }
}

template <typename Body>
fmi2Status guarded(fmi2Component component, const Function& function, Body body) noexcept {
  if (component == nullptr) return fmi2Error;
  Instance& instance = *static_cast<Instance*>(component);
  if (instance.state() == State::fatal) return fmi2Fatal;
  try {
    if (!is_legal(function, instance.state())) throw Error(illegal_call_text(function, instance.state()));
    body(instance);
    return fmi2OK;
  } catch (const Error& error) {
    report(instance, fmi2Error, function, error.what());
    return fmi2Error;
  } catch (const std::exception& error) {
    report(instance, fmi2Fatal, function, error.what());
  } catch (...) {
    report(instance, fmi2Fatal, function, "unknown exception");
  }
  instance.set_state(State::fatal);
  return fmi2Fatal;
}

template <typename T>
std::span<T> checked_array(T* data, std::size_t count, std::string_view name) {
  if (data == nullptr && count != 0) throw Error(fmt::format("the array {} is a null pointer", name));
  return {data, count};
}

template <typename T>
T& checked(T* pointer, std::string_view name) {
  if (pointer == nullptr) throw Error(fmt::format("the argument {} is a null pointer", name));
  return *pointer;
}

/// The saved state behind the handle, as this library made it.
SavedState& saved_state(fmi2FMUstate handle) {
  return *static_cast<SavedState*>(&checked(static_cast<SavedState*>(handle), "FMUstate"));
}

/// Puts a state behind *handle, reusing what is there.
void hand_out(SavedState saved, fmi2FMUstate& handle) {
  if (handle == nullptr)
    handle = std::make_unique<SavedState>(std::move(saved)).release();
  else
    *static_cast<SavedState*>(handle) = std::move(saved);
}

/// Builds what instances share: the C++ library's facets, and the FMU's own tables.
bool prepare() noexcept {
  static_cast<void>(std::locale::classic());
  void (*const prepare_tables)() = &mebots::fmu::prepare_shared_tables;
  try {
    if (prepare_tables != nullptr) prepare_tables();
  } catch (...) {  // NOLINT(bugprone-empty-catch): the first instance builds them again and reports it
  }
  return true;
}

[[noreturn]] void not_offered(std::string_view flag) {
  throw Error(fmt::format("this FMU does not offer it: modelDescription.xml says {}", flag));
}

}  // namespace

/// Every tool calls it after loading the library, before the first instance.
const char* fmi2GetTypesPlatform() {
  static const bool prepared = prepare();
  static_cast<void>(prepared);
  return "default";
}

const char* fmi2GetVersion() {
  return "2.0";
}

fmi2Component fmi2Instantiate(fmi2String instance_name, fmi2Type type, fmi2String guid, fmi2String resource_location,
                              const fmi2CallbackFunctions* functions, fmi2Boolean /*visible*/, fmi2Boolean logging_on) {
  if (functions == nullptr) return nullptr;
  const auto& definition = mebots::fmu::kDefinition;
  const std::string name = instance_name == nullptr ? "" : instance_name;
  try {
    Logger logger(*functions, name, logging_on != fmi2False, definition.log_categories);
    try {
      if (name.empty()) throw Error("the instance name is missing");
      if (type != fmi2CoSimulation) throw Error("only co-simulation is offered, not model exchange");
      if (guid == nullptr || guid != definition.guid)
        throw Error(fmt::format(
            "the GUID {} is not this library's {}; modelDescription.xml and library come from different builds",
            guid == nullptr ? "(null)" : guid, definition.guid));
      auto resources = mebots::shell::path_of_file_uri(resource_location == nullptr ? "" : resource_location);
      return std::make_unique<Instance>(definition, logger, std::move(resources)).release();
    } catch (const Error& error) {
      logger.log(fmi2Error, "logStatusError", fmt::format("fmi2Instantiate: {}", error.what()));
    }
  } catch (...) {  // NOLINT(bugprone-empty-catch): no memory left to say so
  }
  return nullptr;
}

void fmi2FreeInstance(fmi2Component component) {
  delete static_cast<Instance*>(component);
}

fmi2Status fmi2SetDebugLogging(fmi2Component component, fmi2Boolean logging_on, std::size_t category_count,
                               const fmi2String categories[]) {
  return guarded(component, function::kSetDebugLogging, [&](Instance& instance) {
    instance.logger().set_logging(logging_on != fmi2False, checked_array(categories, category_count, "categories"));
  });
}

fmi2Status fmi2SetupExperiment(fmi2Component component, fmi2Boolean /*tolerance_defined*/, fmi2Real /*tolerance*/,
                               fmi2Real start_time, fmi2Boolean stop_time_defined, fmi2Real stop_time) {
  return guarded(component, function::kSetupExperiment, [&](Instance& instance) {
    instance.setup_experiment(start_time, stop_time_defined != fmi2False ? std::optional(stop_time) : std::nullopt);
  });
}

fmi2Status fmi2EnterInitializationMode(fmi2Component component) {
  return guarded(component, function::kEnterInitializationMode,
                 [](Instance& instance) { instance.enter_initialization(); });
}

fmi2Status fmi2ExitInitializationMode(fmi2Component component) {
  return guarded(component, function::kExitInitializationMode,
                 [](Instance& instance) { instance.exit_initialization(); });
}

fmi2Status fmi2Terminate(fmi2Component component) {
  return guarded(component, function::kTerminate, [](Instance& instance) { instance.terminate(); });
}

fmi2Status fmi2Reset(fmi2Component component) {
  return guarded(component, function::kReset, [](Instance& instance) { instance.reset(); });
}

fmi2Status fmi2GetReal(fmi2Component component, const fmi2ValueReference references[], std::size_t count,
                       fmi2Real values[]) {
  return guarded(component, function::kGetReal, [&](Instance& instance) {
    instance.get(checked_array(references, count, "vr"), checked_array(values, count, "value"));
  });
}

fmi2Status fmi2GetInteger(fmi2Component component, const fmi2ValueReference references[], std::size_t count,
                          fmi2Integer values[]) {
  return guarded(component, function::kGetInteger, [&](Instance& instance) {
    instance.get(checked_array(references, count, "vr"), checked_array(values, count, "value"));
  });
}

fmi2Status fmi2GetBoolean(fmi2Component component, const fmi2ValueReference references[], std::size_t count,
                          fmi2Boolean values[]) {
  return guarded(component, function::kGetBoolean, [&](Instance& instance) {
    instance.get_booleans(checked_array(references, count, "vr"), checked_array(values, count, "value"));
  });
}

fmi2Status fmi2GetString(fmi2Component component, const fmi2ValueReference references[], std::size_t count,
                         fmi2String values[]) {
  return guarded(component, function::kGetString, [&](Instance& instance) {
    instance.get(checked_array(references, count, "vr"), checked_array(values, count, "value"));
  });
}

fmi2Status fmi2SetReal(fmi2Component component, const fmi2ValueReference references[], std::size_t count,
                       const fmi2Real values[]) {
  return guarded(component, function::kSetReal, [&](Instance& instance) {
    instance.set(checked_array(references, count, "vr"), checked_array(values, count, "value"));
  });
}

fmi2Status fmi2SetInteger(fmi2Component component, const fmi2ValueReference references[], std::size_t count,
                          const fmi2Integer values[]) {
  return guarded(component, function::kSetInteger, [&](Instance& instance) {
    instance.set(checked_array(references, count, "vr"), checked_array(values, count, "value"));
  });
}

fmi2Status fmi2SetBoolean(fmi2Component component, const fmi2ValueReference references[], std::size_t count,
                          const fmi2Boolean values[]) {
  return guarded(component, function::kSetBoolean, [&](Instance& instance) {
    instance.set_booleans(checked_array(references, count, "vr"), checked_array(values, count, "value"));
  });
}

fmi2Status fmi2SetString(fmi2Component component, const fmi2ValueReference references[], std::size_t count,
                         const fmi2String values[]) {
  return guarded(component, function::kSetString, [&](Instance& instance) {
    instance.set(checked_array(references, count, "vr"), checked_array(values, count, "value"));
  });
}

fmi2Status fmi2GetFMUstate(fmi2Component component, fmi2FMUstate* state) {
  return guarded(component, function::kGetFmuState,
                 [&](Instance& instance) { hand_out(instance.save(), checked(state, "FMUstate")); });
}

fmi2Status fmi2SetFMUstate(fmi2Component component, fmi2FMUstate state) {
  return guarded(component, function::kSetFmuState, [&](Instance& instance) { instance.restore(saved_state(state)); });
}

fmi2Status fmi2FreeFMUstate(fmi2Component component, fmi2FMUstate* state) {
  return guarded(component, function::kFreeFmuState, [&](Instance&) {
    if (state == nullptr) return;
    delete static_cast<SavedState*>(*state);
    *state = nullptr;
  });
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component component, fmi2FMUstate state, std::size_t* size) {
  return guarded(component, function::kSerializedFmuStateSize, [&](Instance& instance) {
    checked(size, "size") = serialize(instance.definition(), saved_state(state)).size();
  });
}

fmi2Status fmi2SerializeFMUstate(fmi2Component component, fmi2FMUstate state, fmi2Byte bytes[], std::size_t size) {
  return guarded(component, function::kSerializeFmuState, [&](Instance& instance) {
    const auto serialized = serialize(instance.definition(), saved_state(state));
    if (size < serialized.size())
      throw Error(fmt::format("the state needs {} bytes, the array has {}; ask fmi2SerializedFMUstateSize",
                              serialized.size(), size));
    std::memcpy(&checked(bytes, "serializedState"), serialized.data(), serialized.size());
  });
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component component, const fmi2Byte bytes[], std::size_t size,
                                   fmi2FMUstate* state) {
  return guarded(component, function::kDeSerializeFmuState, [&](Instance& instance) {
    const auto serialized = checked_array(bytes, size, "serializedState");
    hand_out(mebots::shell::deserialize(instance.definition(), std::as_bytes(serialized)), checked(state, "FMUstate"));
  });
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component component, const fmi2ValueReference[], std::size_t,
                                        const fmi2ValueReference[], std::size_t, const fmi2Real[], fmi2Real[]) {
  return guarded(component, function::kGetDirectionalDerivative,
                 [](Instance&) { not_offered("providesDirectionalDerivative = false"); });
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component component, const fmi2ValueReference[], std::size_t,
                                       const fmi2Integer[], const fmi2Real[]) {
  return guarded(component, function::kSetRealInputDerivatives,
                 [](Instance&) { not_offered("canInterpolateInputs = false"); });
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component component, const fmi2ValueReference[], std::size_t,
                                        const fmi2Integer[], fmi2Real[]) {
  return guarded(component, function::kGetRealOutputDerivatives,
                 [](Instance&) { not_offered("maxOutputDerivativeOrder = 0"); });
}

fmi2Status fmi2DoStep(fmi2Component component, fmi2Real current_point, fmi2Real step_size,
                      fmi2Boolean /*no_set_state_before_current_point*/) {
  return guarded(component, function::kDoStep, [&](Instance& instance) { instance.do_step(current_point, step_size); });
}

fmi2Status fmi2CancelStep(fmi2Component component) {
  return guarded(component, function::kCancelStep, [](Instance&) {});
}

fmi2Status fmi2GetStatus(fmi2Component component, fmi2StatusKind kind, fmi2Status* value) {
  return guarded(component, function::kGetStatus, [&](Instance& instance) {
    if (kind != fmi2DoStepStatus) throw Error("only fmi2DoStepStatus is a status; use the function for the other kind");
    checked(value, "value") = instance.last_step_status();
  });
}

fmi2Status fmi2GetRealStatus(fmi2Component component, fmi2StatusKind kind, fmi2Real* value) {
  return guarded(component, function::kGetRealStatus, [&](Instance& instance) {
    if (kind != fmi2LastSuccessfulTime)
      throw Error("only fmi2LastSuccessfulTime is a Real; use the function for the other kind");
    checked(value, "value") = instance.last_successful_time_s();
  });
}

fmi2Status fmi2GetIntegerStatus(fmi2Component component, fmi2StatusKind /*kind*/, fmi2Integer* /*value*/) {
  return guarded(component, function::kGetIntegerStatus,
                 [](Instance&) { throw Error("FMI 2.0 defines no status that is an Integer"); });
}

fmi2Status fmi2GetBooleanStatus(fmi2Component component, fmi2StatusKind kind, fmi2Boolean* value) {
  return guarded(component, function::kGetBooleanStatus, [&](Instance&) {
    if (kind != fmi2Terminated) throw Error("only fmi2Terminated is a Boolean; use the function for the other kind");
    checked(value, "value") = fmi2False;  // this FMU never asks to end the simulation
  });
}

fmi2Status fmi2GetStringStatus(fmi2Component component, fmi2StatusKind kind, fmi2String* value) {
  return guarded(component, function::kGetStringStatus, [&](Instance&) {
    if (kind != fmi2PendingStatus)
      throw Error("only fmi2PendingStatus is a String; use the function for the other kind");
    checked(value, "value") = "";  // a step is never pending
  });
}
