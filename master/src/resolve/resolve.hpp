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

/// Opens the FMUs of a system description, and resolves and checks its names.
namespace mebots::master {

/// Opens the FMUs, resolves all names, and checks types, causalities, units, start values and connections.
/// `description` must outlive the result. Throws InputError. Throws InterruptedError after an interrupt.
ResolvedSystem resolve(const SystemDescription& description, FmuLibrary& library,
                       const std::atomic<bool>& interrupted = kNeverInterrupted);

/// Opens and unpacks the FMU of an instance without loading its library. Throws InputError with the name of the
/// instance.
std::shared_ptr<Fmu> open_fmu(const InstanceDescription& instance, FmuLibrary& library);

/// Calls `work`. Adds the place of the FMU in the config to each InputError of `work`.
void with_place_of_fmu(const InstanceDescription& instance, const std::function<void()>& work);

/// Returns the values of structural parameters (FMI 3.0) in the description of an instance. Throws InputError.
modeldesc::StructuralValues structural_values(const InstanceDescription& instance,
                                              const modeldesc::ModelDescription& description);

/// Returns the scalar with this name or, for the name of an array element such as `a[2]`, the array; null if there is
/// no such variable. If structural parameters determine the size of the array, the element may be missing at the
/// current size.
const modeldesc::Variable* variable_of_setting(const modeldesc::ModelDescription& description, std::string_view name);

/// Checks the name, type and limits of a setting before the sizes of arrays are known. resolve() later checks whether
/// an array element exists. Returns the value as text. Throws InputError.
std::string checked_setting(const InstanceDescription& instance, Fmu& fmu, const Assignment& setting);

}  // namespace mebots::master
