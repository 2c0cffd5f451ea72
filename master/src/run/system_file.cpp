// SPDX-License-Identifier: Apache-2.0
#include "run/system_file.hpp"

#include "base/packed.hpp"
#include "base/time.hpp"
#include "mebots/input_error.hpp"
#include "message/message_text.hpp"
#include "model/resolved_system.hpp"
#include "record/sink/output_file.hpp"
#include "run/json_value.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <span>
#include <sstream>
#include <string>

namespace mebots::master {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kPanelKinds[] = {"lines", "stack", "lanes"};

void put_unless_empty(Json& object, const char* key, const std::string& text) {
  if (!text.empty()) object[key] = text;
}

/// `source` contains the config, followed by the configs that it extends. Returns the `text` of the first of them that
/// has one. Returns an empty text for an SSP.
std::string text_for_people(const std::string& source) {
  std::istringstream stream(source);
  try {
    for (Json config; stream >> config;) {
      if (config.is_object() && config.contains("text") && config["text"].is_string()) return config["text"];
    }
  } catch (const Json::exception&) {  // NOLINT(bugprone-empty-catch): the end, or no JSON: there is no text
  }
  return {};
}

Json instances_json(const ResolvedSystem& system) {
  auto instances = Json::object();
  for (const auto& instance : system.instances) {
    const auto& model = *instance.model;
    auto& json = add_member(instances, instance.description->name);
    json["model"] = model.model_name;
    put_unless_empty(json, "text", model.text);
    json["step"] = to_seconds(system.description->step_of(*instance.description));
  }
  return instances;
}

/// Returns the variable at one end of a connection. Returns null for an OSMP binary, which consists of three variables.
const modeldesc::Variable* variable_of(const ResolvedSystem& system, const VariableName& name) {
  const auto instance = system.description->index_of(name.instance);
  return instance ? system.instances[*instance].model->find(name.variable) : nullptr;
}

Json connections_json(const ResolvedSystem& system) {
  auto connections = Json::array();
  for (const auto& connection : system.description->connections) {
    const auto* from = variable_of(system, connection.from);
    Json json = {{"from", connection.from.text()}, {"to", connection.to.text()}};
    json["type"] = from != nullptr ? std::string(to_string(from->type)) : "Binary";
    if (from != nullptr) put_unless_empty(json, "unit", from->unit);
    connections.push_back(std::move(json));
  }
  return connections;
}

Json variables_json(const ResolvedSystem& system) {
  auto variables = Json::object();
  for (const auto& recorded : recorded_variables(system)) {
    const auto& variable = *recorded.variable;
    auto& json = add_member(variables, system.text(recorded));
    json["type"] = to_string(variable.type);
    json["causality"] = to_string(variable.causality);
    put_unless_empty(json, "unit", variable.unit);
    put_unless_empty(json, "text", variable.text);
    const auto& model = *system.instances[recorded.instance].model;
    const auto* type = model.type_definition(variable.declared_type);
    if (type == nullptr) continue;
    for (const auto& item : type->items) json["items"].push_back({{"name", item.name}, {"value", item.value}});
  }
  return variables;
}

Json panel_json(const ResolvedSystem& system, const PanelDescription& panel) {
  Json json = {{"title", panel.title}, {"kind", kPanelKinds[static_cast<std::size_t>(panel.kind)]}};
  json["curves"] = Json::array();
  for (const auto& curve : panel.curves) {
    static_cast<void>(system.find(curve.variable, curve.place));
    Json entry = {{curve.rate ? "rate_of" : "variable", curve.variable.text()}};
    put_unless_empty(entry, "label", curve.label);
    json["curves"].push_back(std::move(entry));
  }
  return json;
}

Json pictures_json(const SystemDescription& description) {
  auto pictures = Json::array();
  for (const auto& entry : description.pictures) pictures.push_back(entry.frame.text());
  return pictures;
}

/// Returns the groups of the summary. Each group maps members to variables.
Json groups_json(const SystemDescription& description) {
  auto groups = Json::array();
  for (const auto& entry : description.summary) {
    if (entry.group.empty()) continue;
    Json members = Json::object();
    for (const auto& member : entry.group) add_member(members, member.name) = member.variable.text();
    groups.push_back({{"label", fmt::format("{}", fmt::join(entry.path, " "))}, {"members", std::move(members)}});
  }
  return groups;
}

Json view_json(const ResolvedSystem& system) {
  const auto& view = system.description->view;
  Json json = {{"panels", Json::array()}, {"marks", view.marks}};
  if (view.scene) json["scene"] = {{"file", kSceneFile}, {"instance", view.scene->instance}};
  if (auto groups = groups_json(*system.description); !groups.empty()) json["groups"] = std::move(groups);
  for (const auto& panel : view.panels) json["panels"].push_back(panel_json(system, panel));
  return json;
}

}  // namespace

Json system_json(const ResolvedSystem& system) {
  const auto& description = *system.description;
  Json json;
  json["name"] = description.name;
  put_unless_empty(json, "text", text_for_people(description.source));
  json["step"] = to_seconds(description.step);
  json["stop_time"] = description.grid().time_s(description.stop_time_ns);
  json["instances"] = instances_json(system);
  json["connections"] = connections_json(system);
  json["variables"] = variables_json(system);
  json["pictures"] = pictures_json(description);
  json["view"] = view_json(system);
  return json;
}

SystemFileWriter::SystemFileWriter(const ResolvedSystem& system, Ensemble& ensemble, std::filesystem::path folder)
    : ensemble_(&ensemble), folder_(std::move(folder)) {
  system_text_ = system_json(system).dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  const auto& view = system.description->view;
  if (!view.scene) return;
  scene_ = system.find(*view.scene, view.scene_place);
  if (scene_->variable->type != modeldesc::Type::string) {
    throw InputError(ErrorCode::wrong_type,
                     fmt::format("{}: {} is not a String, as a scene must be", view.scene_place, view.scene->text()));
  }
}

std::optional<std::string> SystemFileWriter::reached(const Point& point) {
  if (point.step != 0) return std::nullopt;
  write_whole(folder_ / kSystemFile, system_text_);
  if (!scene_) return std::nullopt;
  std::string text;
  const auto reference = scene_->variable->value_reference;
  ensemble_->slave(scene_->instance).get_strings(std::span(&reference, 1), std::span(&text, 1));
  write_whole(folder_ / kSceneFile, gzipped(valid_utf8(text), Packing::fast));
  return std::nullopt;
}

}  // namespace mebots::master
