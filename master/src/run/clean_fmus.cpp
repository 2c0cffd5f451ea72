// SPDX-License-Identifier: Apache-2.0
#include "run/clean_fmus.hpp"

#include "mebots/input_error.hpp"

#include <fmt/format.h>

#include <map>
#include <mutex>
#include <set>
#include <utility>

namespace mebots::master {
namespace {

constexpr std::string_view kWayOut = "Give its instances \"process\": \"own\"";

std::string name_of(const Fmu& fmu) {
  return fmu.archive().filename().string();
}

/// The number of current runs that use a kind of process-wide data, and the first FMU that imported a function which
/// changes the data.
struct Use {
  int runs = 0;
  std::string fmu;
};

struct Uses {
  std::mutex mutex;
  std::map<std::string_view, Use> by_what;
};

Uses& uses() {
  static Uses& all = *new Uses;  // never destroyed, because a run may be closed at process exit
  return all;
}

/// Maps each imported process-wide function to the name of the first FMU that imports it. Skips instances in separate
/// processes.
std::map<const ProcessFunction*, std::string> functions_of(const ResolvedSystem& system) {
  std::map<const ProcessFunction*, std::string> functions;
  for (const auto& instance : system.instances) {
    if (instance.description->isolation.alone()) continue;
    for (const auto* function : instance.fmu->imports().functions) functions.emplace(function, name_of(*instance.fmu));
  }
  return functions;
}

}  // namespace

std::vector<Leftover> leftovers_of(const ResolvedSystem& system) {
  std::vector<Leftover> leftovers;
  std::set<std::pair<const Fmu*, bool>> seen;
  for (const auto& instance : system.instances) {
    const bool in_process = !instance.description->isolation.alone();
    if (!seen.emplace(instance.fmu.get(), in_process).second) continue;
    auto why = instance.fmu->uncleanliness();
    if (!why) why = instance.fmu->difference();
    if (why) leftovers.push_back({fmt::format("{}: {}", name_of(*instance.fmu), *why), in_process});
  }
  return leftovers;
}

std::optional<std::string> fmu_without_whole_state(const ResolvedSystem& system) {
  for (const auto& instance : system.instances) {
    if (const auto why = instance.fmu->state_elsewhere())
      return fmt::format("instance '{}': the saved state of {} is incomplete: {}", instance.description->name,
                         name_of(*instance.fmu), *why);
  }
  return std::nullopt;
}

void require_whole_states(const ResolvedSystem& system, std::string_view what) {
  if (const auto why = fmu_without_whole_state(system)) {
    throw InputError(ErrorCode::not_offered,
                     fmt::format("{}: {}. Run it from t = 0: without a fork, splitting or a saved state", what, *why));
  }
}

ProcessUse::ProcessUse(const ResolvedSystem& system) {
  const auto functions = functions_of(system);
  auto& all = uses();
  const std::lock_guard lock(all.mutex);
  bool renews = false;
  for (const auto& [function, fmu] : functions) {
    const auto found = all.by_what.find(function->what);
    if (found != all.by_what.end() && function->remedy == Remedy::none) {
      throw InputError(ErrorCode::not_offered,
                       fmt::format("{}: it imports {}, which changes {}. {} ran in this process before and does the "
                                   "same, so another run would not begin as in a fresh process. {}",
                                   fmu, readable_name(*function), function->what, found->second.fmu, kWayOut));
    }
    if (function->remedy != Remedy::renewed) continue;
    renews = true;
    if (found != all.by_what.end() && found->second.runs > 0) {
      throw InputError(ErrorCode::not_offered,
                       fmt::format("{}: it imports {}, which changes {}. {} does the same in another run that has not "
                                   "ended, so each run would change the other. {}",
                                   fmu, readable_name(*function), function->what, found->second.fmu, kWayOut));
    }
  }
  if (renews) renew_c_library();
  std::set<std::string_view> used;
  for (const auto& [function, fmu] : functions) {
    if (!used.insert(function->what).second) continue;
    auto& use = all.by_what[function->what];
    ++use.runs;
    if (use.fmu.empty()) use.fmu = fmu;
  }
  used_.assign(used.begin(), used.end());
}

ProcessUse::~ProcessUse() {
  auto& all = uses();
  const std::lock_guard lock(all.mutex);
  for (const auto& what : used_) --all.by_what[what].runs;
}

}  // namespace mebots::master
