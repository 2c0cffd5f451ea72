// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/signal_guard.hpp"
#include "fmi/fmu.hpp"
#include "model/resolved_system.hpp"

#include <atomic>
#include <functional>
#include <memory>

/// From what the user asks for to a system that is checked: opens FMUs, looks up names.
namespace mebots::master {

/// Opens the FMUs, looks up all names and checks types, causalities, units, start values and connections.
/// `description` must outlive the result. Throws InputError, and InterruptedError between two FMUs.
ResolvedSystem resolve(const SystemDescription& description, FmuLibrary& library,
                       const std::atomic<bool>& interrupted = kNeverInterrupted);

/// The FMU of an instance, unpacked and described; its library is not loaded. Throws InputError that names the
/// instance.
std::shared_ptr<Fmu> open_fmu(const InstanceDescription& instance, FmuLibrary& library);

/// Runs `work`; an InputError from it gets the place in the config that names the FMU.
void with_place_of_fmu(const InstanceDescription& instance, const std::function<void()>& work);

/// The values of an instance's structural parameters (FMI 3.0) that its description sets. Throws InputError.
modeldesc::StructuralValues structural_values(const InstanceDescription& instance,
                                              const modeldesc::ModelDescription& description);

}  // namespace mebots::master
