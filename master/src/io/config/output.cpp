// SPDX-License-Identifier: Apache-2.0
// Reads `record`, `pictures`, `log`, `view` and `summary`. The summary consists of labels, which may be nested. A label
// refers to a variable, a variable with conditions, or a group of variables.
#include "sections.hpp"

#include "model/name_pattern.hpp"
#include "model/resolved_system.hpp"

#include <fmt/format.h>

#include <set>
#include <string>

namespace mebots::master::config {
namespace {

std::vector<RecordPattern> read_patterns(const Node& node) {
  return data::list_of([](const Node& element) {
    return RecordPattern{element.readable_text(), element.place()};
  })(node);
}

/// Reads the parameters to record: `true` for all, or patterns.
std::vector<RecordPattern> read_recorded_parameters(const Node& node) {
  if (!node.is(data::Kind::boolean)) return read_patterns(node);
  return node.flag() ? std::vector<RecordPattern>{{"*", node.place()}} : std::vector<RecordPattern>{};
}

struct Format {
  bool csv;
  bool hdf5;
};

}  // namespace

void read_record(const Node& node, SystemDescription& system) {
  static const auto format_of =
      data::word_of<Format>({{"csv", {true, false}}, {"hdf5", {false, true}}, {"both", {true, true}}});
  auto& record = system.record;
  if (node.is(data::Kind::list)) {
    record.patterns = read_patterns(node);
    return;
  }
  Object object(node);
  object.read_if("variables", record.patterns, &read_patterns);
  object.read_if("exclude", record.exclude, &read_patterns);
  object.read_if("parameters", record.parameters, &read_recorded_parameters);
  Format format{record.csv, record.hdf5};
  object.read_if("format", format, format_of);
  record.csv = format.csv;
  record.hdf5 = format.hdf5;
  object.read_if("texts", record.texts, &Node::flag);
  object.read_if("locals", record.locals, &Node::flag);
  object.read_if("step", record.step, &Node::flag);
  object.read_if("interval", record.every_steps, [&](const Node& member) { return steps_in(member, system); });
  object.finish();
}

namespace {

constexpr std::int32_t kLargestPictureWidth = 65536;

PictureDescription read_picture(const Node& node, const SystemDescription& system) {
  Object object(node);
  PictureDescription pictures;
  pictures.place = node.place();
  object.read("frame", pictures.frame, variable_of(system));
  object.read("id", pictures.id, variable_of(system));
  object.read("width", pictures.width,
              [](const Node& width) { return static_cast<std::int32_t>(width.whole_number(1, kLargestPictureWidth)); });
  object.read_if("interval", pictures.interval_ns, &duration_ns);
  object.finish();
  return pictures;
}

}  // namespace

void read_pictures(const Node& node, SystemDescription& system) {
  system.pictures = data::list_of([&](const Node& element) { return read_picture(element, system); })(node);
}

void read_log(const Node& node, SystemDescription& system) {
  for (const auto& [name, categories] : node.members()) {
    categories.attempt([&, &name = name, &categories = categories] {
      system.log.push_back({instance_name(name, categories, system), data::list_of(&Node::readable_text)(categories)});
    });
  }
}

namespace {

CurveDescription read_curve(const Node& node, const SystemDescription& system) {
  Object object(node);
  CurveDescription curve;
  curve.place = node.place();
  curve.rate = object.has("rate_of");
  if (curve.rate && object.has("variable")) {
    node.complain(ErrorCode::invalid_value, "a curve needs exactly one of 'variable' and 'rate_of'");
  }
  object.read(curve.rate ? "rate_of" : "variable", curve.variable, variable_of(system));
  object.read_if("label", curve.label, &Node::readable_text);
  object.allow({"variable"});
  object.finish();
  return curve;
}

PanelDescription read_panel(const Node& node, const SystemDescription& system) {
  static const auto kind_of =
      data::word_of<PanelKind>({{"lines", PanelKind::lines}, {"stack", PanelKind::stack}, {"lanes", PanelKind::lanes}});
  Object object(node);
  PanelDescription panel;
  object.read("title", panel.title, &Node::readable_text);
  object.read_if("kind", panel.kind, kind_of);
  object.read("curves", panel.curves, data::list_of([&](const Node& element) { return read_curve(element, system); }));
  object.finish();
  return panel;
}

/// Adds the instance with this name, or all instances that match a pattern.
void add_mark(const Node& node, const SystemDescription& system, std::vector<std::string>& marks) {
  const auto name = node.readable_text();
  const bool selects_several = is_pattern(name) && system.find_instance(name) == nullptr;
  const auto before = marks.size();
  for (const auto& instance : system.instances) {
    if (selects_several && fits(instance.name, name)) marks.push_back(instance.name);
  }
  if (marks.size() == before) marks.push_back(instance_name(name, node, system));
}

}  // namespace

void read_view(const Node& node, SystemDescription& system) {
  Object object(node);
  auto& view = system.view;
  object.visit_if("scene", [&](const Node& scene) {
    view.scene = variable_name(scene, system);
    view.scene_place = scene.place();
  });
  object.read_if("panels", view.panels,
                 data::list_of([&](const Node& element) { return read_panel(element, system); }));
  object.visit_if("marks", [&](const Node& marks) {
    for (const auto& element : marks.elements()) {
      element.attempt([&] { add_mark(element, system, view.marks); });
    }
  });
  object.finish();
}

namespace {

ConditionDescription read_final_condition(const Node& node, const SystemDescription& system) {
  Object object(node);
  auto condition = read_condition(object, system);
  object.finish();
  return condition;
}

/// Reads a summary entry with conditions. Its value is valid only if they are true at the end of the run.
SummaryEntry read_conditional(const Node& node, const std::vector<std::string>& path, const SystemDescription& system) {
  Object object(node);
  SummaryEntry entry{path, {}, {}, node.place()};
  object.read("variable", entry.variable, variable_of(system));
  object.read("when", entry.when,
              data::list_of([&](const Node& element) { return read_final_condition(element, system); }));
  object.finish();
  return entry;
}

/// Reads a group of variables, for example of several drones. A member without a name is named by its position in the
/// list, from 1.
std::vector<GroupMember> read_group(const Node& node, const SystemDescription& system) {
  std::vector<GroupMember> group;
  std::set<std::string> names;
  for (const auto& element : node.elements()) {
    element.attempt([&] {
      Object object(element);
      GroupMember member{std::to_string(group.size() + 1), {}, element.place()};
      object.read("variable", member.variable, variable_of(system));
      object.read_if("name", member.name, &Node::readable_text);
      object.finish();
      if (!names.insert(member.name).second)
        element.complain(ErrorCode::duplicate_name, fmt::format("two members are named '{}'", member.name));
      group.push_back(std::move(member));
    });
  }
  if (group.empty()) node.complain(ErrorCode::invalid_value, "a group needs at least one member");
  return group;
}

bool is_conditional(const Node& node) {
  const auto when = node.find("when");
  return node.has("variable") && when && when->is(data::Kind::list);
}

// Reads nested labels. The document limits the depth of the recursion.
void read_labels(const Node& node, const std::vector<std::string>& path, SystemDescription& system) {
  for (const auto& [label, value] : node.members()) {
    value.attempt([&, &label = label, &value = value] {
      auto inner = path;
      inner.push_back(label);
      if (value.is(data::Kind::list)) {
        system.summary.push_back({std::move(inner), {}, {}, value.place(), read_group(value, system)});
      } else if (!value.is(data::Kind::object)) {
        auto name = variable_name(value, system);
        system.summary.push_back({std::move(inner), std::move(name), {}, value.place()});
      } else if (is_conditional(value)) {
        system.summary.push_back(read_conditional(value, inner, system));
      } else {
        read_labels(value, inner, system);
      }
    });
  }
}

}  // namespace

void read_summary(const Node& node, SystemDescription& system) {
  read_labels(node, {}, system);
}

}  // namespace mebots::master::config
