// SPDX-License-Identifier: Apache-2.0
#include "slave/process_watch.hpp"

#include "fmi/fmu.hpp"
#include "model/resolved_system.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

namespace mebots::master {
namespace {

std::set<std::string> fmus_here(const ResolvedSystem& system) {
  std::set<std::string> names;
  for (const auto& instance : system.instances) {
    if (!instance.isolation.alone()) names.insert(instance.fmu->archive().filename().string());
  }
  return names;
}

/// Returns the quoted names of up to eight instances in this process, and the number of the others.
std::string instances_here(const ResolvedSystem& system) {
  constexpr std::size_t kShown = 8;
  std::vector<std::string> names;
  for (const auto& instance : system.instances) {
    if (!instance.description->isolation.alone()) names.push_back(fmt::format("'{}'", instance.description->name));
  }
  const auto more = names.size() - std::min(names.size(), kShown);
  names.resize(names.size() - more);
  return fmt::format("{}{}", fmt::join(names, ", "), more == 0 ? "" : fmt::format(" and {} more", more));
}

}  // namespace

ProcessWatch::ProcessWatch(const ResolvedSystem& system, MessageSink& messages)
    : system_(&system), messages_(&messages) {
  for (const auto& instance : system.instances) {
    if (!instance.isolation.alone()) reach_ = std::max(reach_, instance.fmu->imports().reach);
  }
  begin();
}

/// Stores the state for look(). Includes only the descriptors of standard input, output and error, because mebots opens
/// and closes others.
void ProcessWatch::begin() {
  before_.reset();
  if (reach_ != ProcessReach::nothing) before_.emplace(standard_files(), reach_);
}

void ProcessWatch::look(const std::string& during, std::int64_t time_ns) {
  if (!before_) return;
  const auto changes = before_->put_right();
  if (changes.empty()) return;
  const auto fmus = fmus_here(*system_);
  const auto text = fmt::format("{} {} changed the whole process {}: {}; instances of {}: {}",
                                fmus.size() == 1 ? "the FMU" : "one of the FMUs", fmt::join(fmus, ", "), during,
                                fmt::join(changes, "; "), fmus.size() == 1 ? "it" : "them", instances_here(*system_));
  messages_->message({{}, Severity::warning, "notice", text, time_ns});
  begin();
}

}  // namespace mebots::master
