// SPDX-License-Identifier: Apache-2.0
#include "run/summary.hpp"

#include "base/sha256.hpp"
#include "base/time.hpp"
#include "mebots/hexadecimal.hpp"
#include "message/message_text.hpp"
#include "run/json_value.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <span>
#include <utility>

namespace mebots::master {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kOwnLabels[] = {
    "outcome",    "end_reason",  "end_text",         "error",          "simulated_time", "stop_time", "step",
    "steps",      "rows",        "real_time_factor", "wall_clock",     "units",          "versions",  "inputs",
    "notices",    "statistics",  "scenario",         "lost_instances", "parameters",     "coupling",  "start_time",
    "error_code", "uncertainty", "solvers"};

constexpr std::string_view kEach = "each";

std::string text_of(const Json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

/// A tree of values by nested labels in the order of insertion. Finds a label in logarithmic time; an ordered JSON
/// object would need linear time.
class LabelTree {
 public:
  /// `path` must not be empty.
  void put(std::span<const std::string> path, Json value) {
    const auto [place, added] = places_.emplace(path.front(), children_.size());
    if (added) children_.emplace_back(path.front(), LabelTree());
    auto& child = children_[place->second].second;
    if (path.size() > 1) {
      child.put(path.subspan(1), std::move(value));
    } else {
      child.value_ = std::move(value);
    }
  }

  Json json() const {
    if (children_.empty()) return value_;
    Json object;
    for (const auto& [label, child] : children_) add_member(object, label) = child.json();
    return object;
  }

 private:
  std::map<std::string, std::size_t> places_;  // indices of children by label
  std::vector<std::pair<std::string, LabelTree>> children_;
  Json value_ = Json::object();  // value of a leaf; an empty tree has an empty object
};

/// Appends the members of `more` to `object`. The two must not share a label.
void append(Json& object, Json more) {
  for (auto& [label, value] : more.get_ref<Json::object_t&>()) add_member(object, label) = std::move(value);
}

/// Returns the FMU as the config names it. For an FMU of an SSP, returns its path inside the archive.
std::string fmu_text(const SystemDescription& system, const InstanceDescription& instance) {
  if (!system.unpacked) return instance.fmu;
  const auto inside = instance.fmu_path.lexically_relative(system.unpacked->path());
  return inside.empty() || inside.begin()->string() == ".." ? instance.fmu : inside.string();
}

}  // namespace

SummaryValues::SummaryValues(const ResolvedSystem& system, Ensemble& ensemble) : ensemble_(&ensemble) {
  for (const auto& entry : system.description->summary) {
    if (std::find(std::begin(kOwnLabels), std::end(kOwnLabels), entry.path.front()) != std::end(kOwnLabels)) {
      throw InputError(ErrorCode::duplicate_name,
                       fmt::format("{}: the label '{}' is used by summary.json itself; choose another one", entry.place,
                                   entry.path.front()));
    }
    if (entry.group.empty()) {
      add_entry(system, ensemble, entry);
    } else {
      add_group(system, ensemble, entry);
    }
  }
}

void SummaryValues::add_entry(const ResolvedSystem& system, Ensemble& ensemble, const SummaryEntry& entry) {
  const auto resolved = system.find(entry.variable, entry.place);
  const auto& model = *system.instances[resolved.instance].model;
  auto& added =
      entries_.emplace_back(Entry{entry.path, &model, resolved.variable, ensemble.watch(resolved), {}, true, 0, 0, {}});
  for (const auto& condition : entry.when) added.when.emplace_back(system, ensemble, condition);
}

void SummaryValues::add_group(const ResolvedSystem& system, Ensemble& ensemble, const SummaryEntry& entry) {
  groups_.push_back({entry.path, entries_.size(), entry.group.size()});
  for (const auto& member : entry.group) {
    auto path = entry.path;
    path.insert(path.end(), {std::string(kEach), member.name});
    add_entry(system, ensemble, {std::move(path), member.variable, {}, member.place});
    const auto& first = *entries_[groups_.back().first].variable;
    const auto& own = *entries_.back().variable;
    if (own.type == first.type && own.unit == first.unit) continue;
    throw InputError(ErrorCode::wrong_type,
                     fmt::format("{}: '{}' is of type {} [{}], the first member of the group of type {} [{}]",
                                 member.place, member.variable.text(), modeldesc::to_string(own.type), own.unit,
                                 modeldesc::to_string(first.type), first.unit));
  }
}

std::optional<std::string> SummaryValues::reached(const Point& /*point*/) {
  any_point_ = true;
  for (auto& entry : entries_) {
    entry.shown = std::ranges::all_of(entry.when, &Condition::holds);
    switch (entry.signal.kind) {
      case ValueKind::real:
        entry.number = ensemble_->real(entry.signal);
        break;
      case ValueKind::integer:
      case ValueKind::boolean:
        entry.whole = ensemble_->integer(entry.signal);
        break;
      case ValueKind::string:
        entry.text = valid_utf8(ensemble_->string(entry.signal));
        break;
      case ValueKind::binary:
        entry.text = hexadecimal(ensemble_->string(entry.signal));
        break;
      case ValueKind::clock:
        break;
    }
  }
  return std::nullopt;
}

Json SummaryValues::value_of(const Entry& entry) const {
  switch (entry.signal.kind) {
    case ValueKind::real:
      return json_of(entry.variable->type, entry.number);
    case ValueKind::boolean:
      return entry.whole != 0;
    case ValueKind::string:
    case ValueKind::binary:
      return entry.text;
    case ValueKind::clock:
    case ValueKind::integer:
      break;
  }
  if (const auto* type = entry.model->type_definition(entry.variable->declared_type); type != nullptr) {
    for (const auto& item : type->items) {
      if (item.value == entry.whole) return item.name;
    }
  }
  return json_of(entry.variable->type, entry.whole);
}

Json SummaryValues::statistics_of(const Group& group) const {
  const auto members = std::span(entries_).subspan(group.first, group.count);
  const auto& first = members.front();
  const auto* type = first.model->type_definition(first.variable->declared_type);
  const bool is_item = type != nullptr && !type->items.empty();
  if (first.signal.kind == ValueKind::boolean)
    return {{"count", std::ranges::count_if(members, [](const Entry& one) { return one.whole != 0; })},
            {"of", members.size()}};
  if (is_item || (first.signal.kind != ValueKind::real && first.signal.kind != ValueKind::integer)) {
    Json counts = Json::object();
    for (const auto& one : members) {
      const auto text = text_of(value_of(one));
      counts[text] = counts.value(text, 0) + 1;
    }
    return {{"counts", counts}};
  }
  const auto number = [&](const Entry& one) {
    return one.signal.kind == ValueKind::real ? one.number : number_of(first.variable->type, one.whole);
  };
  const auto least = std::ranges::min_element(members, {}, number);
  const auto most = std::ranges::max_element(members, {}, number);
  double sum = 0;
  for (const auto& one : members) sum += number(one);
  return {{"least", value_of(*least)},
          {"mean", sum / static_cast<double>(members.size())},
          {"most", value_of(*most)},
          {"least_of", least->path.back()},
          {"most_of", most->path.back()}};
}

Json SummaryValues::values() const {
  LabelTree tree;
  if (!any_point_) return tree.json();
  auto group = groups_.begin();
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    if (group != groups_.end() && group->first == i) {
      auto path = group->path;
      path.emplace_back();
      const auto statistics = statistics_of(*group++);
      for (const auto& [label, value] : statistics.items()) {
        path.back() = label;
        tree.put(path, value);
      }
    }
    if (entries_[i].shown) tree.put(entries_[i].path, value_of(entries_[i]));
  }
  return tree.json();
}

Json SummaryValues::units() const {
  LabelTree tree;
  for (const auto& group : groups_) {
    const auto& unit = entries_[group.first].variable->unit;
    auto path = group.path;
    path.emplace_back();
    for (const auto* label : {"least", "mean", "most"}) {
      path.back() = label;
      if (!unit.empty()) tree.put(path, unit);
    }
  }
  for (const auto& entry : entries_) {
    if (entry.shown && !entry.variable->unit.empty()) tree.put(entry.path, entry.variable->unit);
  }
  return tree.json();
}

double RunReport::real_time_factor() const {
  return wall.stepping_s > 0 ? to_seconds(simulated_ns) / wall.stepping_s : 0;
}

Json summary_json(const ResolvedSystem& system, const InputHash& hash, const RunReport& report,
                  const SummaryValues& values) {
  const auto& description = *system.description;
  Json json;
  json["outcome"] = report.outcome;
  if (report.end_reason) json["end_reason"] = name_of(*report.end_reason);
  json["end_text"] = report.end_text;
  if (!report.error.empty()) {
    json["error"] = report.error;
    json["error_code"] = name_of(report.error_code);
  }
  json["simulated_time"] = to_seconds(report.simulated_ns);
  json["real_time_factor"] = report.real_time_factor();
  append(json, values.values());
  json["step"] = to_seconds(description.step);
  json["steps"] = report.steps;
  if (description.start_time_ns != 0) json["start_time"] = to_seconds(description.start_time_ns);
  json["stop_time"] = description.grid().time_s(description.stop_time_ns);
  json["rows"] = report.rows;

  Json units = {{"simulated_time", "s"}, {"step", "s"}, {"stop_time", "s"}, {"wall_clock", "s"}};
  if (description.start_time_ns != 0) units["start_time"] = "s";
  append(units, values.units());
  json["units"] = units;
  json["wall_clock"] = {{"open", report.wall.open_s},
                        {"initialise", report.wall.initialise_s},
                        {"stepping", report.wall.stepping_s},
                        {"total", report.wall.open_s + report.wall.initialise_s + report.wall.stepping_s}};

  // Completes each part before it is added, because an ordered JSON object moves its members when it grows.
  Json versions = {{"mebots", MEBOTS_VERSION}};
  // The start values that the run set. They are necessary to compare two runs.
  Json parameters;
  for (const auto& instance : system.instances) {
    if (instance.starts.empty()) continue;
    auto& of_instance = add_member(parameters, instance.description->name);
    for (const auto& start : instance.starts)
      add_member(of_instance, start.variable->name) = json_of(start.variable->type, start.value);
  }
  Json inputs;
  inputs["sha256"] = hash.all;
  inputs["config"] = {{"file", description.file.filename().string()}, {"sha256", hash.config}};
  inputs["changes"] = report.overrides;
  if (!report.writes.empty()) inputs["writes"] = report.writes;
  if (report.further_writes > 0) inputs["further_writes"] = report.further_writes;
  for (const auto& [name, digest] : hash.files) inputs["files"][name] = {{"sha256", digest}};
  Json versions_of_fmus;
  Json fmus;
  for (std::size_t i = 0; i < system.instances.size(); ++i) {
    const auto& instance = *system.instances[i].description;
    const auto& model = *system.instances[i].model;
    add_member(versions_of_fmus, instance.name) = {{"model", model.model_name},
                                                   {"version", model.version},
                                                   {"generation_tool", model.generation_tool},
                                                   {"guid", model.guid}};
    add_member(fmus, instance.name) = {{"file", fmu_text(description, instance)}, {"sha256", hash.fmus[i].second}};
  }
  versions["instances"] = std::move(versions_of_fmus);
  inputs["fmus"] = std::move(fmus);
  json["versions"] = std::move(versions);
  if (!parameters.is_null()) json["parameters"] = std::move(parameters);
  json["inputs"] = std::move(inputs);
  json["notices"] = report.notices;
  return json;
}

}  // namespace mebots::master
