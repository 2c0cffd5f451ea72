// SPDX-License-Identifier: Apache-2.0
#include "mebots/master/nearest_names.hpp"
#include "mebots/master/system_description.hpp"
#include "mebots/master/time.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <sstream>

namespace mebots::master {
namespace {

constexpr int kLargestPictureWidth = 65536;

WrittenValue written_value(const JsonNode& node) {
  const auto& value = node.value();
  if (value.is_boolean()) return value.get<bool>();
  if (value.is_number_integer() && !(value.is_number_unsigned() && value.get<std::uint64_t>() > INT64_MAX)) {
    return value.get<std::int64_t>();
  }
  if (value.is_number()) return value.get<double>();
  if (value.is_string()) return value.get<std::string>();
  node.fail("a number, true, false or a text is expected here");
}

VariableName variable_name(const JsonNode& node, const SystemDescription& system) {
  const auto text = node.string();
  const auto dot = text.find('.');
  if (dot == std::string::npos || dot == 0 || dot + 1 == text.size()) {
    node.fail(fmt::format("'{}' does not name a variable; write instance.variable", text));
  }
  VariableName name{text.substr(0, dot), text.substr(dot + 1)};
  if (system.find_instance(name.instance) == nullptr) {
    node.fail(
        fmt::format("there is no instance '{}'. {}", name.instance, suggest(name.instance, system.instance_names())));
  }
  return name;
}

std::string readable_text(const JsonNode& node) {
  auto text = node.string();
  if (text.empty()) node.fail("the text is empty");
  return text;
}

void check_instance_name(const std::string& name, const JsonNode& node) {
  if (name.empty()) node.fail("an instance needs a name");
  if (name.find('.') != std::string::npos) {
    node.fail(
        fmt::format("the instance name '{}' holds a dot, which separates instance and variable; rename it", name));
  }
  const bool control =
      std::any_of(name.begin(), name.end(), [](char c) { return static_cast<unsigned char>(c) < ' '; });
  if (control) node.fail("the instance name holds a control character");
}

InstanceDescription read_instance(const std::string& name, const JsonNode& node, const SystemDescription& system) {
  check_instance_name(name, node);
  node.expect_keys({"fmu", "parameters", "step", "text"});
  InstanceDescription instance;
  instance.name = name;
  instance.place = node.place();
  const auto fmu = node.at("fmu");
  instance.fmu = readable_text(fmu);
  instance.fmu_path = system.file.parent_path() / instance.fmu;  // an absolute path stays as it is
  std::error_code error;
  const auto path = std::filesystem::canonical(instance.fmu_path, error);
  if (error) {
    fmu.fail(fmt::format("there is no FMU at {} ({}); paths are relative to the config",
                         instance.fmu_path.lexically_normal().string(), error.message()));
  }
  instance.fmu_path = path;
  if (const auto parameters = node.find("parameters")) {
    for (const auto& [variable, value] : parameters->members()) {
      instance.parameters.push_back({variable, written_value(value), value.place()});
    }
  }
  instance.step_ns = system.step_ns;
  if (const auto step = node.find("step")) {
    instance.step_ns = step->nanoseconds();
    if (instance.step_ns <= 0 || instance.step_ns % system.step_ns != 0) {
      step->fail(fmt::format("the instance's step {} s is not a multiple of the system's step {} s",
                             to_seconds(instance.step_ns), to_seconds(system.step_ns)));
    }
  }
  return instance;
}

ConditionDescription read_condition(const JsonNode& node, const SystemDescription& system) {
  ConditionDescription condition;
  condition.place = node.place();
  condition.variable = variable_name(node.at("variable"), system);
  int comparisons = 0;
  const auto compare = [&](const char* key, Comparison comparison) {
    const auto value = node.find(key);
    if (!value) return;
    ++comparisons;
    condition.comparison = comparison;
    if (comparison != Comparison::equals) value->number();
    condition.value = written_value(*value);
  };
  compare("equals", Comparison::equals);
  compare("above", Comparison::above);
  compare("below", Comparison::below);
  if (comparisons != 1) node.fail("a condition needs exactly one of 'equals', 'above' and 'below'");
  return condition;
}

ConditionDescription read_stop_condition(const JsonNode& node, const SystemDescription& system) {
  node.expect_keys({"variable", "equals", "above", "below", "for"});
  auto condition = read_condition(node, system);
  if (const auto duration = node.find("for")) {
    condition.for_ns = duration->nanoseconds();
    if (condition.for_ns < 0) duration->fail("a time cannot be negative");
  }
  return condition;
}

OutcomeDescription read_outcome(const JsonNode& node, const SystemDescription& system) {
  node.expect_keys({"outcome", "when"});
  OutcomeDescription outcome;
  outcome.outcome = readable_text(node.at("outcome"));
  if (const auto when = node.find("when")) {
    for (const auto& element : when->elements()) {
      element.expect_keys({"variable", "equals", "above", "below", "ever"});
      auto condition = read_condition(element, system);
      if (const auto ever = element.find("ever")) condition.ever = ever->boolean();
      outcome.when.push_back(std::move(condition));
    }
  }
  return outcome;
}

void read_summary(const JsonNode& node, const std::vector<std::string>& path, SystemDescription& system) {
  for (const auto& [label, value] : node.members()) {
    auto inner = path;
    inner.push_back(label);
    if (value.value().is_object()) {
      read_summary(value, inner, system);
    } else {
      system.summary.push_back({inner, variable_name(value, system), value.place()});
    }
  }
}

RecordDescription read_record(const JsonNode& node, const SystemDescription& system) {
  RecordDescription record;
  std::optional<JsonNode> patterns;
  if (node.value().is_array()) {
    patterns = node;
  } else {
    node.expect_keys({"variables", "interval"});
    patterns = node.find("variables");
    if (const auto interval = node.find("interval")) {
      record.interval_ns = interval->nanoseconds();
      if (record.interval_ns <= 0 || record.interval_ns % system.step_ns != 0) {
        interval->fail(
            fmt::format("the recording interval is not a multiple of the step {} s", to_seconds(system.step_ns)));
      }
    }
  }
  if (patterns) {
    record.patterns.emplace();
    for (const auto& element : patterns->elements())
      record.patterns->push_back({readable_text(element), element.place()});
  }
  return record;
}

PictureDescription read_pictures(const JsonNode& node, const SystemDescription& system) {
  node.expect_keys({"frame", "id", "width", "interval"});
  PictureDescription pictures;
  pictures.place = node.place();
  pictures.frame = variable_name(node.at("frame"), system);
  pictures.id = variable_name(node.at("id"), system);
  const auto width = node.at("width");
  if (!width.value().is_number_integer() || width.number() < 1 || width.number() > kLargestPictureWidth) {
    width.fail(fmt::format("the width must be a whole number of pixels from 1 to {}", kLargestPictureWidth));
  }
  pictures.width = static_cast<std::int32_t>(width.number());
  if (const auto interval = node.find("interval")) {
    pictures.interval_ns = interval->nanoseconds();
    if (pictures.interval_ns < 0) interval->fail("a time cannot be negative");
  }
  return pictures;
}

LogDescription read_log(const std::string& instance, const JsonNode& node, const SystemDescription& system) {
  if (system.find_instance(instance) == nullptr) {
    node.fail(fmt::format("there is no instance '{}'. {}", instance, suggest(instance, system.instance_names())));
  }
  LogDescription log{instance, {}};
  for (const auto& element : node.elements()) log.categories.push_back(readable_text(element));
  return log;
}

std::string read_bytes(const std::filesystem::path& file) {
  if (std::filesystem::is_directory(file)) {
    throw InputError(fmt::format("{}: this is a folder; name a config file", file.string()));
  }
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError(fmt::format("{}: this config cannot be opened; does the file exist?", file.string()));
  std::ostringstream bytes;
  bytes << stream.rdbuf();
  if (stream.bad()) throw InputError(fmt::format("{}: this config cannot be read", file.string()));
  return bytes.str();
}

}  // namespace

SystemDescription read_config(const std::filesystem::path& file) {
  SystemDescription system;
  system.source = read_bytes(file);
  system.file = std::filesystem::absolute(file);
  system.name = file.stem().string();

  const auto json = parse_json(system.source, file.string());
  const JsonNode root(json, file.string());
  root.expect_keys({"text", "step", "stop_time", "instances", "connections", "stop_when", "outcomes", "summary",
                    "record", "pictures", "log"});
  const auto step = root.at("step");
  system.step_ns = step.nanoseconds();
  if (system.step_ns <= 0) step.fail("the step must be greater than 0 s");
  const auto stop_time = root.at("stop_time");
  const auto stop_time_ns = stop_time.nanoseconds();

  const auto instances = root.at("instances");
  for (const auto& [name, node] : instances.members()) system.instances.push_back(read_instance(name, node, system));
  if (system.instances.empty()) instances.fail("there is nothing to simulate; name at least one instance");
  set_stop_time(system, stop_time_ns, stop_time.place());

  for (const auto& node : root.at("connections").elements()) {
    node.expect_keys({"from", "to"});
    const auto from = variable_name(node.at("from"), system);
    system.connections.push_back({from, variable_name(node.at("to"), system), node.place()});
  }
  if (const auto nodes = root.find("stop_when")) {
    for (const auto& node : nodes->elements()) system.stop_when.push_back(read_stop_condition(node, system));
  }
  if (const auto nodes = root.find("outcomes")) {
    for (const auto& node : nodes->elements()) system.outcomes.push_back(read_outcome(node, system));
  }
  if (const auto node = root.find("summary")) read_summary(*node, {}, system);
  if (const auto node = root.find("record")) system.record = read_record(*node, system);
  if (const auto nodes = root.find("pictures")) {
    for (const auto& node : nodes->elements()) system.pictures.push_back(read_pictures(node, system));
  }
  if (const auto node = root.find("log")) {
    for (const auto& [instance, categories] : node->members()) {
      system.log.push_back(read_log(instance, categories, system));
    }
  }
  return system;
}

}  // namespace mebots::master
