// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/signal_guard.hpp"
#include "fmi/fmu.hpp"
#include "model/resolved_system.hpp"

#include <atomic>
#include <functional>
#include <memory>

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

}  // namespace mebots::master
