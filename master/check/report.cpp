// SPDX-License-Identifier: Apache-2.0
#include "check_fmu.hpp"

#include "mebots/error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>

namespace mebots::check {
namespace {

constexpr std::string_view kLevelNames[] = {"interoperable", "standard", "pedantic"};  // in the order of Level

}  // namespace

std::string_view to_string(Severity severity) {
  return severity == Severity::error ? "error" : "warning";
}

std::string_view to_string(Group group) {
  switch (group) {
    case Group::archive:
      return "archive";
    case Group::description:
      return "description";
    case Group::binaries:
      return "binaries";
    case Group::behaviour:
      break;
  }
  return "behaviour";
}

std::string_view to_string(Level level) {
  return kLevelNames[static_cast<std::size_t>(level)];
}

std::vector<std::string> level_names() {
  return {std::begin(kLevelNames), std::end(kLevelNames)};
}

Level level_named(std::string_view name) {
  const auto* const found = std::ranges::find(kLevelNames, name);
  if (found == std::end(kLevelNames))
    throw Error(ErrorCode::unknown_name,
                fmt::format("there is no level '{}'; the levels are {}", name, fmt::join(kLevelNames, ", ")));
  return static_cast<Level>(found - std::begin(kLevelNames));
}

std::size_t Report::count(Severity severity) const {
  std::size_t found = 0;
  for (const auto& check : checks)
    found += static_cast<std::size_t>(std::ranges::count(check.findings, severity, &Finding::severity));
  return found;
}

std::string to_text(const Report& report) {
  std::string text = fmt::format("{}{}{}\n", report.fmu, report.summary.empty() ? "" : ": ", report.summary);
  for (const Group group : {Group::archive, Group::description, Group::binaries, Group::behaviour}) {
    std::size_t passed = 0;
    std::string lines;
    std::map<std::string, std::vector<std::string>> skipped;  // checks by reason
    for (const auto& check : report.checks) {
      if (check.group != group) continue;
      if (!check.skipped.empty()) skipped[check.skipped].push_back(check.name);
      if (check.skipped.empty() && check.findings.empty()) ++passed;
      for (const auto& finding : check.findings)
        lines +=
            fmt::format("  {:<8} {}\n           -> {}\n", to_string(finding.severity), finding.text, finding.way_out);
    }
    if (group == Group::binaries) {
      for (const auto& platform : report.platforms)
        lines += fmt::format("  binaries/{}: {}\n", platform.folder, to_text(platform));
    }
    if (passed == 0 && lines.empty() && skipped.empty()) continue;
    for (const auto& [why, what] : skipped)
      lines += fmt::format("  skipped  {}: {}\n",
                           what.size() == 1 ? what.front() : fmt::format("{} checks", what.size()), why);
    text += fmt::format("{:<12} {} check{} passed\n{}", to_string(group), passed, passed == 1 ? "" : "s", lines);
  }
  const auto errors = report.count(Severity::error);
  const auto warnings = report.count(Severity::warning);
  text += report.clean() ? fmt::format("clean at level {}", to_string(report.level))
                         : fmt::format("{} error{}, {} warning{} at level {}", errors, errors == 1 ? "" : "s", warnings,
                                       warnings == 1 ? "" : "s", to_string(report.level));
  return text +
         (report.hidden_findings == 0 ? "\n" : fmt::format("; {} more at a higher --level\n", report.hidden_findings));
}

std::string to_json(const Report& report) {
  nlohmann::ordered_json json;
  json["fmu"] = report.fmu;
  json["summary"] = report.summary;
  json["level"] = to_string(report.level);
  json["clean"] = report.clean();
  json["errors"] = report.count(Severity::error);
  json["warnings"] = report.count(Severity::warning);
  json["platforms"] = nlohmann::ordered_json::array();
  for (const auto& platform : report.platforms)
    json["platforms"].push_back({{"folder", platform.folder},
                                 {"machine", platform.machine},
                                 {"glibc", platform.glibc},
                                 {"missing", platform.missing}});
  json["checks"] = nlohmann::ordered_json::array();
  for (const auto& check : report.checks) {
    nlohmann::ordered_json one;
    one["group"] = to_string(check.group);
    one["name"] = check.name;
    one["result"] = !check.skipped.empty() ? "skipped" : check.findings.empty() ? "passed" : "failed";
    if (!check.skipped.empty()) one["why"] = check.skipped;
    one["findings"] = nlohmann::ordered_json::array();
    for (const auto& finding : check.findings)
      one["findings"].push_back({{"severity", to_string(finding.severity)},
                                 {"level", to_string(finding.level)},
                                 {"text", finding.text},
                                 {"way_out", finding.way_out}});
    json["checks"].push_back(std::move(one));
  }
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace mebots::check
