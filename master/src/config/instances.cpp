// SPDX-License-Identifier: Apache-2.0
// The section `instances`: a table of the keys of one instance, each with its own reader.
#include "base/time.hpp"
#include "config/config_schema.hpp"
#include "slave/find_fmu.hpp"

#include "reading.hpp"
#include "sections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace mebots::master::config {
namespace {

using ReadKey = void (*)(const JsonNode&, InstanceDescription&, const SystemDescription&);

void check_name(const std::string& name, const JsonNode& node, const SystemDescription& system) {
  if (name.empty()) node.fail("an instance needs a name");
  for (const auto& other : system.instances) {
    const auto& [shorter, longer] =
        std::minmax(name, other.name, [](const std::string& a, const std::string& b) { return a.size() < b.size(); });
    if (!longer.starts_with(shorter + ".")) continue;
    node.fail(
        fmt::format("the instance '{}' could be a variable of the instance '{}'; rename one of them", longer, shorter));
  }
  const bool control =
      std::any_of(name.begin(), name.end(), [](char c) { return static_cast<unsigned char>(c) < ' '; });
  if (control) node.fail("the instance name holds a control character");
}

void read_fmu(const JsonNode& node, InstanceDescription& instance, const SystemDescription& system) {
  instance.fmu = readable_text(node);
  try {
    instance.fmu_path = find_fmu(instance.fmu, system.file.parent_path());
  } catch (const InputError& error) {
    node.fail(error.what());
  }
}

void read_parameters(const JsonNode& node, InstanceDescription& instance, const SystemDescription& /*system*/) {
  for (const auto& [variable, value] : node.members()) {
    instance.parameters.push_back({variable, written_value(value), value.place()});
  }
}

void read_step_multiple(const JsonNode& node, InstanceDescription& instance, const SystemDescription& system) {
  instance.step_ns = node.nanoseconds();
  if (instance.step_ns <= 0 || instance.step_ns % system.step_ns != 0) {
    node.fail(fmt::format("the instance's step {} s is not a multiple of the system's step {} s",
                          to_seconds(instance.step_ns), to_seconds(system.step_ns)));
  }
}

void read_process(const JsonNode& node, InstanceDescription& instance, const SystemDescription& /*system*/) {
  const auto process = node.string();
  if (process != "own" && process != "shared") {
    node.fail(fmt::format("'{}' is neither 'own' (a process for this instance) nor 'shared' (the master's)", process));
  }
  instance.isolation.own_process = process == "own";
}

/// Nobody can end a call, or bound the memory, of an FMU inside the master's process.
void need_own_process(const JsonNode& node, const InstanceDescription& instance) {
  if (instance.isolation.own_process == false) node.fail("this needs \"process\": \"own\"");
}

void read_deadline(const JsonNode& node, InstanceDescription& instance, const SystemDescription& /*system*/) {
  need_own_process(node, instance);
  instance.isolation.deadline_s = node.number();
  if (!(*instance.isolation.deadline_s > 0)) node.fail("a deadline is a time greater than 0 s");
}

void read_memory_limit(const JsonNode& node, InstanceDescription& instance, const SystemDescription& /*system*/) {
  constexpr double kLargestMb = 1 << 24;  // 16 TiB
  need_own_process(node, instance);
  const double limit_mb = node.number();
  if (limit_mb < 1 || limit_mb > kLargestMb || limit_mb != std::floor(limit_mb)) {
    node.fail(fmt::format("the limit must be a whole number of MiB from 1 to {}", kLargestMb));
  }
  instance.isolation.memory_bytes = static_cast<std::uint64_t>(limit_mb) << 20;
}

void read_on_failure(const JsonNode& node, InstanceDescription& instance, const SystemDescription& /*system*/) {
  const auto wish = node.string();
  if (wish != "stop" && wish != "continue") {
    node.fail(fmt::format("'{}' is neither 'stop' (the run ends) nor 'continue' (the others go on)", wish));
  }
  instance.isolation.go_on_without = wish == "continue";
}

void read_on_discard(const JsonNode& node, InstanceDescription& instance, const SystemDescription& /*system*/) {
  const auto text = node.string();
  if (text != "end" && text != "divide") {
    node.fail(fmt::format("'{}' is unknown here; write \"end\" (the run ends) or \"divide\" (repeat the step in parts)",
                          text));
  }
  instance.divide_discarded = text == "divide";
}

void read_instance_text(const JsonNode& node, InstanceDescription& /*instance*/, const SystemDescription& /*system*/) {
  node.string();  // for people only
}

struct Key {
  std::string_view name;
  bool required;
  ReadKey read;
};

constexpr Key kKeys[] = {
    {"fmu", true, &read_fmu},
    {"parameters", false, &read_parameters},
    {"step", false, &read_step_multiple},
    {"process", false, &read_process},  // before those that need one of its own
    {"deadline", false, &read_deadline},
    {"memory_limit_mb", false, &read_memory_limit},
    {"on_failure", false, &read_on_failure},
    {"on_discard", false, &read_on_discard},
    {"text", false, &read_instance_text},
};

InstanceDescription read_instance(const std::string& name, const JsonNode& node, const SystemDescription& system) {
  check_name(name, node, system);
  std::vector<std::string_view> names;
  for (const auto& key : kKeys) names.push_back(key.name);
  node.expect_keys(names);
  InstanceDescription instance;
  instance.name = name;
  instance.place = node.place();
  instance.step_ns = system.step_ns;
  for (const auto& key : kKeys) {
    if (key.required || node.has(key.name)) key.read(node.at(key.name), instance, system);
  }
  return instance;
}

}  // namespace

void read_instances(const JsonNode& node, SystemDescription& system) {
  for (const auto& [name, instance] : node.members()) {
    system.instances.push_back(read_instance(name, instance, system));
  }
  if (system.instances.empty()) node.fail("there is nothing to simulate; name at least one instance");
}

}  // namespace mebots::master::config

namespace mebots::master {

std::vector<std::string> instance_keys() {
  std::vector<std::string> keys;
  for (const auto& key : config::kKeys) keys.emplace_back(key.name);
  return keys;
}

}  // namespace mebots::master
