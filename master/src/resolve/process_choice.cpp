// SPDX-License-Identifier: Apache-2.0
#include "resolve/signal_coverage.hpp"

#include "slave/isolation/child_process.hpp"

#include "resolve/resolve.hpp"

#include "base/signal_guard.hpp"
#include "fmi/library_state.hpp"
#include "mebots/input_error.hpp"
#include "model/resolved_system.hpp"
#include "model/value_kind.hpp"
#include "slave/fmi/intermediate_inputs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>

namespace mebots::master {
namespace {

/// The instances of an FMU in this process.
struct Group {
  std::shared_ptr<Fmu> fmu;
  std::vector<ResolvedInstance*> instances;
};

bool demands_shared(const ResolvedInstance* instance) {
  return instance->description->isolation.process == ProcessKind::shared;
}

/// Returns the instances in this process, grouped by FMU. The largest groups come first, because the later one of two
/// FMUs that cannot share a process gets separate processes.
std::vector<Group> groups_by_size(ResolvedSystem& system) {
  std::vector<Group> groups;
  std::map<const Fmu*, std::size_t> places;
  for (auto& instance : system.instances) {
    if (instance.isolation.alone()) continue;
    const auto [place, first] = places.emplace(instance.fmu.get(), groups.size());
    if (first) groups.push_back({instance.fmu, {}});
    groups[place->second].instances.push_back(&instance);
  }
  std::ranges::stable_sort(groups, std::ranges::greater(), [](const Group& group) { return group.instances.size(); });
  return groups;
}

std::string listed_names(const std::vector<ResolvedInstance*>& instances) {
  constexpr std::size_t kShown = 5;
  std::vector<std::string_view> names;
  for (std::size_t i = 0; i < std::min(kShown, instances.size()); ++i)
    names.emplace_back(instances[i]->description->name);
  const auto more = instances.size() - names.size();
  return fmt::format("{}{}", fmt::join(names, ", "), more == 0 ? "" : fmt::format(" and {} more", more));
}

void isolate(ResolvedSystem& system, const std::vector<ResolvedInstance*>& instances, const std::string& reason) {
  for (auto* instance : instances) {
    instance->isolation.process = ProcessKind::own;
    instance->isolation.memory_bytes = IsolationDescription::kNoMemoryLimit;
  }
  const auto archive = instances.front()->fmu->archive().filename().string();
  system.notices.push_back(fmt::format("{}: {} runs in its own process{}: {}", listed_names(instances), archive,
                                       instances.size() == 1 ? "" : " per instance", reason));
}

[[noreturn]] void refuse(const ResolvedInstance& instance, const std::string& reason) {
  throw InputError(ErrorCode::fmu_unsupported,
                   fmt::format("{}/process: {} cannot run in the \"shared\" process: {}. Leave \"process\" out, and it "
                               "runs in its own process",
                               instance.description->place, instance.fmu->archive().string(), reason));
}

void load(ResolvedSystem& system, const Group& group) {
  const auto demanding = std::ranges::find_if(group.instances, demands_shared);
  const bool demanded = demanding != group.instances.end();
  const auto& first = *group.instances.front()->description;
  Admission admission;
  with_place_of_fmu(first,
                    [&] { admission = load_into_this_process(group.fmu, demanded ? Risk::accept : Risk::refuse); });
  if (admission.reason.empty()) return;
  if (demanded && !admission.loaded) refuse(**demanding, admission.reason);
  std::vector<ResolvedInstance*> leaving;
  std::vector<ResolvedInstance*> staying;
  for (auto* instance : group.instances) (demands_shared(instance) ? staying : leaving).push_back(instance);
  if (!leaving.empty()) isolate(system, leaving, admission.reason);
  if (staying.empty()) return;
  system.notices.push_back(fmt::format("{}: {} shares the master's process, as the config requires, although {}",
                                       listed_names(staying), group.fmu->archive().filename().string(),
                                       admission.reason));
}

/// If an FMU permits only one instance per process, moves its other instances to separate processes.
void part_single_instances(ResolvedSystem& system) {
  std::map<const Fmu*, const ResolvedInstance*> users;
  for (auto& instance : system.instances) {
    if (instance.isolation.alone()) continue;
    if (!instance.implementation().can_be_instantiated_only_once_per_process) continue;
    const auto [user, first] = users.emplace(instance.fmu.get(), &instance);
    if (first) continue;
    const auto reason =
        fmt::format("it allows one instance per process (canBeInstantiatedOnlyOncePerProcess), and '{}' is already one",
                    user->second->description->name);
    if (demands_shared(&instance)) refuse(instance, reason);
    isolate(system, {&instance}, reason);
  }
}

/// Throws InputError or adds a notice if the config uses a feature that is not available for FMUs under wine.
void check_windows_fmus(ResolvedSystem& system) {
  for (const auto& instance : system.instances) {
    if (!instance.isolation.alone() || !instance.fmu->runs_under_wine()) continue;
    const auto refuse = [&](std::string_view reason) {
      throw InputError(ErrorCode::fmu_unsupported,
                       fmt::format("{}: {} has a binary for Windows alone, which runs under wine, and {}",
                                   instance.description->place, instance.fmu->archive().string(), reason));
    };
    if (instance.isolation.sandboxed())
      refuse(
          "wine does not run in a sandbox. Set \"process\" to \"own\", which survives a crash of the FMU, but does not "
          "limit its access to files");
    if (!osmp_triples(*instance.model).empty())
      refuse("its binary variables (OSMP) are addresses in its own process. Export it for FMI 3.0, or for Linux");
    if (instance.model->is_fmi3() && !IntermediateInputs(*instance.model).empty()) {
      system.notices.push_back(fmt::format(
          "{}: {} runs under wine and cannot call back for inputs within a step: they are constant during a step",
          instance.description->name, instance.fmu->archive().filename().string()));
    }
  }
}

void find_interpreters(ResolvedSystem& system) {
  std::map<const Fmu*, Interpreter> known;
  for (auto& instance : system.instances) {
    if (!instance.isolation.alone()) continue;
    const auto [place, first] = known.try_emplace(instance.fmu.get());
    if (first) place->second = interpreter_of(*instance.fmu);
    instance.interpreter = place->second;
  }
}

}  // namespace

void choose_processes(ResolvedSystem& system, const std::atomic<bool>& interrupted) {
  for (const auto& group : groups_by_size(system)) {
    stop_if_interrupted(interrupted);
    load(system, group);
  }
  part_single_instances(system);
  check_windows_fmus(system);
  find_interpreters(system);
}

}  // namespace mebots::master
