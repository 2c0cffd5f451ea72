// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/fmi/find_functions.hpp"
#include "mebots/fmi1/types.hpp"

#include <string>

/// Contains pointers to the functions in the shared library of an FMI 1.0 FMU for co-simulation. In the library, the
/// name of each function begins with the FMU's modelIdentifier and an underscore.
namespace mebots::fmi1 {

/// States why a function is needed. `to_run`: a simulation is impossible without it. `always`: the standard requires
/// it, but a simulation is possible without it.
enum class Need { to_run, always };

/// Pointers to the FMI functions in the library of an FMU. A pointer is null if the library lacks the function.
struct Functions {
  fmiString (*get_types_platform)() = nullptr;
  fmiString (*get_version)() = nullptr;
  fmiComponent (*instantiate_slave)(fmiString instance_name, fmiString guid, fmiString fmu_location,
                                    fmiString mime_type, fmiReal timeout_ms, fmiBoolean visible, fmiBoolean interactive,
                                    fmiCallbackFunctions functions, fmiBoolean logging_on) = nullptr;
  fmiStatus (*initialize_slave)(fmiComponent, fmiReal start_time, fmiBoolean stop_time_defined,
                                fmiReal stop_time) = nullptr;
  fmiStatus (*terminate_slave)(fmiComponent) = nullptr;
  fmiStatus (*reset_slave)(fmiComponent) = nullptr;
  void (*free_slave_instance)(fmiComponent) = nullptr;
  fmiStatus (*set_debug_logging)(fmiComponent, fmiBoolean logging_on) = nullptr;
  fmiStatus (*get_real)(fmiComponent, const fmiValueReference[], std::size_t count, fmiReal values[]) = nullptr;
  fmiStatus (*get_integer)(fmiComponent, const fmiValueReference[], std::size_t count, fmiInteger values[]) = nullptr;
  fmiStatus (*get_boolean)(fmiComponent, const fmiValueReference[], std::size_t count, fmiBoolean values[]) = nullptr;
  fmiStatus (*get_string)(fmiComponent, const fmiValueReference[], std::size_t count, fmiString values[]) = nullptr;
  fmiStatus (*set_real)(fmiComponent, const fmiValueReference[], std::size_t count, const fmiReal values[]) = nullptr;
  fmiStatus (*set_integer)(fmiComponent, const fmiValueReference[], std::size_t count,
                           const fmiInteger values[]) = nullptr;
  fmiStatus (*set_boolean)(fmiComponent, const fmiValueReference[], std::size_t count,
                           const fmiBoolean values[]) = nullptr;
  fmiStatus (*set_string)(fmiComponent, const fmiValueReference[], std::size_t count,
                          const fmiString values[]) = nullptr;
  fmiStatus (*set_real_input_derivatives)(fmiComponent, const fmiValueReference[], std::size_t count,
                                          const fmiInteger orders[], const fmiReal values[]) = nullptr;
  fmiStatus (*get_real_output_derivatives)(fmiComponent, const fmiValueReference[], std::size_t count,
                                           const fmiInteger orders[], fmiReal values[]) = nullptr;
  fmiStatus (*do_step)(fmiComponent, fmiReal current_point, fmiReal step_size, fmiBoolean new_step) = nullptr;
  fmiStatus (*cancel_step)(fmiComponent) = nullptr;
  fmiStatus (*get_status)(fmiComponent, fmiStatusKind kind, fmiStatus* value) = nullptr;
  fmiStatus (*get_real_status)(fmiComponent, fmiStatusKind kind, fmiReal* value) = nullptr;
};

/// Calls action(name, fmi::kMember<pointer to member>, Need) for each member of Functions.
template <typename Action>
void for_each_function(Action action) {
  using F = Functions;
  action("fmiGetTypesPlatform", fmi::kMember<&F::get_types_platform>, Need::to_run);
  action("fmiGetVersion", fmi::kMember<&F::get_version>, Need::to_run);
  action("fmiInstantiateSlave", fmi::kMember<&F::instantiate_slave>, Need::to_run);
  action("fmiInitializeSlave", fmi::kMember<&F::initialize_slave>, Need::to_run);
  action("fmiTerminateSlave", fmi::kMember<&F::terminate_slave>, Need::to_run);
  action("fmiResetSlave", fmi::kMember<&F::reset_slave>, Need::always);
  action("fmiFreeSlaveInstance", fmi::kMember<&F::free_slave_instance>, Need::to_run);
  action("fmiSetDebugLogging", fmi::kMember<&F::set_debug_logging>, Need::always);
  action("fmiGetReal", fmi::kMember<&F::get_real>, Need::to_run);
  action("fmiGetInteger", fmi::kMember<&F::get_integer>, Need::to_run);
  action("fmiGetBoolean", fmi::kMember<&F::get_boolean>, Need::to_run);
  action("fmiGetString", fmi::kMember<&F::get_string>, Need::to_run);
  action("fmiSetReal", fmi::kMember<&F::set_real>, Need::to_run);
  action("fmiSetInteger", fmi::kMember<&F::set_integer>, Need::to_run);
  action("fmiSetBoolean", fmi::kMember<&F::set_boolean>, Need::to_run);
  action("fmiSetString", fmi::kMember<&F::set_string>, Need::to_run);
  action("fmiSetRealInputDerivatives", fmi::kMember<&F::set_real_input_derivatives>, Need::always);
  action("fmiGetRealOutputDerivatives", fmi::kMember<&F::get_real_output_derivatives>, Need::always);
  action("fmiDoStep", fmi::kMember<&F::do_step>, Need::to_run);
  action("fmiCancelStep", fmi::kMember<&F::cancel_step>, Need::always);
  action("fmiGetStatus", fmi::kMember<&F::get_status>, Need::always);
  action("fmiGetRealStatus", fmi::kMember<&F::get_real_status>, Need::always);
}

/// Looks up all members of Functions in a loaded library. `library` is its handle from dlopen(), or from LoadLibrary()
/// on Windows.
inline Functions find_functions(void* library, const std::string& model_identifier) {
  return fmi::find_functions<Functions>(
      library, [](auto action) { for_each_function(action); }, model_identifier + "_");
}

}  // namespace mebots::fmi1
