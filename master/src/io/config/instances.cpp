// SPDX-License-Identifier: Apache-2.0
// Reads `instances`. A table contains a reader for each key of an instance.
#include "io/config/load_system.hpp"
#include "io/find_fmu.hpp"
#include "model/sandbox_mechanisms.hpp"

#include "sections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <set>

namespace mebots::master::config {
namespace {

/// The data that a reader of a key may use.
struct Surroundings {
  const SystemDescription& system;  // contains the sections and instances that were already read
  FmuSearch& fmus;
};

using ReadKey = void (*)(const Node&, InstanceDescription&, const Surroundings&);

void check_name(const std::string& name, const Node& node, const std::set<std::string, std::less<>>& others) {
  if (name.empty()) node.complain(ErrorCode::invalid_value, "an instance needs a name");
  const auto complain = [&](std::string_view longer, std::string_view shorter) {
    node.complain(
        ErrorCode::invalid_value,
        fmt::format("the instance '{}' could be a variable of the instance '{}'; rename one of them", longer, shorter));
  };
  const std::string_view text = name;
  for (auto dot = text.find('.'); dot != std::string_view::npos; dot = text.find('.', dot + 1)) {
    if (others.contains(text.substr(0, dot))) complain(name, text.substr(0, dot));
  }
  for (auto other = others.lower_bound(name + "."); other != others.end() && other->starts_with(name + "."); ++other) {
    complain(*other, name);
  }
  const bool control =
      std::any_of(name.begin(), name.end(), [](char c) { return static_cast<unsigned char>(c) < ' '; });
  if (control) node.complain(ErrorCode::invalid_value, "the instance name contains a control character");
}

void read_fmu(const Node& node, InstanceDescription& instance, const Surroundings& around) {
  instance.fmu = node.readable_text();
  const auto& answer = around.fmus.find(instance.fmu);
  if (!answer.problem.empty()) node.complain(ErrorCode::fmu_not_found, answer.problem);
  instance.fmu_path = answer.path;
}

void read_parameters(const Node& node, InstanceDescription& instance, const Surroundings& /*around*/) {
  for (const auto& [variable, value] : node.members()) {
    value.attempt([&, &variable = variable, &value = value] {
      instance.parameters.push_back({variable, written_value(value), value.place()});
    });
  }
}

void read_step_multiple(const Node& node, InstanceDescription& instance, const Surroundings& around) {
  instance.steps = steps_in(node, around.system);
}

void read_process(const Node& node, InstanceDescription& instance, const Surroundings& /*around*/) {
  instance.isolation.process = data::word_of<ProcessKind>(
      {{"own", ProcessKind::own}, {"shared", ProcessKind::shared}, {"sandboxed", ProcessKind::sandboxed}})(node);
}

std::string mechanism_in(const Node& node) {
  return data::word_of<std::string>({{kNamespaces, kNamespaces}, {kLandlock, kLandlock}, {kSeccomp, kSeccomp}})(node);
}

/// Reports a mistake if the instance runs in the process of the master, which cannot abort its calls or limit its
/// memory.
void need_own_process(const Node& node, const InstanceDescription& instance) {
  if (instance.isolation.process == ProcessKind::shared) {
    node.fail(ErrorCode::invalid_value, "this needs \"process\": \"own\" or \"sandboxed\"");
  }
}

void read_deadline(const Node& node, InstanceDescription& instance, const Surroundings& /*around*/) {
  need_own_process(node, instance);
  instance.isolation.deadline_s = node.number(data::Limits::positive());
}

void read_memory_limit(const Node& node, InstanceDescription& instance, const Surroundings& /*around*/) {
  constexpr std::int64_t kLargestMb = 1 << 24;  // 16 TiB
  need_own_process(node, instance);
  instance.isolation.memory_bytes = static_cast<std::uint64_t>(node.whole_number(1, kLargestMb)) << 20;
}

/// Reads `sandbox`. "reads" contains paths relative to the config; "may_lack" contains names of mechanisms.
void read_sandbox(const Node& node, InstanceDescription& instance, const Surroundings& around) {
  if (!instance.isolation.sandboxed()) node.fail(ErrorCode::invalid_value, "this needs \"process\": \"sandboxed\"");
  Object object(node);
  object.visit_if("reads", [&](const Node& list) {
    for (const auto& path : list.elements()) {
      const auto place = (around.system.file.parent_path() / path.text()).lexically_normal();
      instance.isolation.sandbox.reads.push_back(std::filesystem::absolute(place).string());
    }
  });
  object.visit_if("may_lack", [&](const Node& list) {
    for (const auto& name : list.elements()) instance.isolation.sandbox.may_lack.push_back(mechanism_in(name));
  });
  object.finish();
}

void read_on_failure(const Node& node, InstanceDescription& instance, const Surroundings& /*around*/) {
  instance.isolation.continue_without = data::word_of<bool>({{"stop", false}, {"continue", true}})(node);
}

void read_on_discard(const Node& node, InstanceDescription& instance, const Surroundings& /*around*/) {
  instance.divide_discarded = data::word_of<bool>({{"end", false}, {"divide", true}})(node);
}

void read_pass_stop_time(const Node& node, InstanceDescription& instance, const Surroundings& /*around*/) {
  instance.pass_stop_time = node.flag();
}

/// Reads a tolerance: a number, or `false` for no tolerance.
void read_tolerance(const Node& node, InstanceDescription& instance, const Surroundings& /*around*/) {
  if (node.is(data::Kind::boolean)) {
    if (node.flag()) node.fail(ErrorCode::invalid_value, "write a number above 0, or false to pass no tolerance");
    instance.pass_tolerance = false;
  } else {
    instance.tolerance = node.number(data::Limits::positive());
  }
}

void read_kind(const Node& node, InstanceDescription& instance, const Surroundings& /*around*/) {
  instance.kind = data::word_of<FmuKind>(
      {{"co_simulation", FmuKind::co_simulation}, {"model_exchange", FmuKind::model_exchange}})(node);
}

void read_own_solver(const Node& node, InstanceDescription& instance, const Surroundings& /*around*/) {
  instance.solver = solver_description(node);
}

void read_instance_text(const Node& node, InstanceDescription& /*instance*/, const Surroundings& /*around*/) {
  static_cast<void>(node.text());  // the text is only for readers of the file
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
    {"process", false, &read_process},  // must precede the keys that require a separate process
    {"deadline", false, &read_deadline},
    {"memory_limit_mb", false, &read_memory_limit},
    {"sandbox", false, &read_sandbox},
    {"on_failure", false, &read_on_failure},
    {"on_discard", false, &read_on_discard},
    {"pass_stop_time", false, &read_pass_stop_time},
    {"tolerance", false, &read_tolerance},
    {"kind", false, &read_kind},
    {"solver", false, &read_own_solver},
    {"text", false, &read_instance_text},
};

void read_instance(const Node& node, InstanceDescription& instance, const Surroundings& around) {
  Object object(node);
  for (const auto& key : kKeys) {
    const auto read = [&](const Node& member) { key.read(member, instance, around); };
    if (key.required) {
      object.visit(key.name, read);
    } else {
      object.visit_if(key.name, read);
    }
  }
  object.finish();
}

}  // namespace

void read_instances(const Node& node, SystemDescription& system) {
  std::set<std::string, std::less<>> names;
  FmuSearch fmus(system.file.parent_path());
  for (const auto& [name, member] : node.members()) {
    check_name(name, member, names);
    names.insert(name);
    InstanceDescription instance;
    instance.name = name;
    instance.place = member.place();
    member.attempt([&, &member = member] { read_instance(member, instance, {system, fmus}); });
    system.instances.push_back(std::move(instance));  // even if invalid, because other sections contain its name
  }
  if (system.instances.empty()) {
    node.fail(ErrorCode::invalid_value, "there is nothing to simulate; name at least one instance");
  }
}

}  // namespace mebots::master::config

namespace mebots::master {

std::vector<std::string> instance_keys() {
  std::vector<std::string> keys;
  for (const auto& key : config::kKeys) keys.emplace_back(key.name);
  keys.emplace_back(config::kRepeat);
  return keys;
}

}  // namespace mebots::master
