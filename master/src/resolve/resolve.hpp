// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/signal_guard.hpp"
#include "fmi/fmu.hpp"
#include "model/resolved_system.hpp"

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

/// Converts the user's description to a checked system: opens FMUs and resolves names.
namespace mebots::master {

/// Opens the FMUs, resolves all names and checks types, causalities, units, start values and connections. `description`
/// must outlive the result. Throws InputError, and InterruptedError between two FMUs.
ResolvedSystem resolve(const SystemDescription& description, FmuLibrary& library,
                       const std::atomic<bool>& interrupted = kNeverInterrupted);

/// Returns the FMU of an instance, unpacked and described; its library is not loaded. Throws InputError that names the
/// instance.
std::shared_ptr<Fmu> open_fmu(const InstanceDescription& instance, FmuLibrary& library);

/// Calls `work`, and adds the place of the FMU in the config to the InputErrors that it throws.
void with_place_of_fmu(const InstanceDescription& instance, const std::function<void()>& work);

/// Returns the values that an instance's description sets for its structural parameters (FMI 3.0). Throws InputError.
modeldesc::StructuralValues structural_values(const InstanceDescription& instance,
                                              const modeldesc::ModelDescription& description);

/// Returns the variable that a setting of this name changes: a scalar, or the array of an element. If structural
/// parameters determine the array's size, the element need not exist yet. Returns null for any other name.
const modeldesc::Variable* variable_of_setting(const modeldesc::ModelDescription& description, std::string_view name);

/// Checks name, type and limits of a setting while the sizes of arrays may still change. resolve() checks again whether
/// an array has the element. Returns the value as text. Throws InputError.
std::string checked_setting(const InstanceDescription& instance, Fmu& fmu, const Assignment& setting);

}  // namespace mebots::master
