// SPDX-License-Identifier: Apache-2.0
// The sections `text`, `step`, `start_time` and `stop_time`.
// The sections `algorithm` and `solver`.
// The section `threads`: "auto" or a number.
// The section `coupling`.
#include "mebots/input_error.hpp"
#include "sections.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <set>

namespace mebots::master::config {

void read_text(const Node& node, SystemDescription& /*system*/) {
  static_cast<void>(node.text());  // for people only
}

void read_step(const Node& node, SystemDescription& system) {
  const auto step = step_time(node);
  if (node.kind() != data::Kind::text && !step.is_whole_nanoseconds()) {
    system.notices.push_back(fmt::format("{}: the step {} s means {} s", node.place(), node.shown(), time_text(step)));
  }
  system.step = step;
}

void read_start_time(const Node& node, SystemDescription& system) {
  const auto start_time = written_time(node);
  if (!start_time.is_whole_nanoseconds()) {
    node.fail(ErrorCode::invalid_value,
              fmt::format("the start time {} s must be a whole number of nanoseconds", node.shown()));
  }
  system.start_time_ns = to_nanoseconds(start_time);
}

void read_stop_time(const Node& node, SystemDescription& system) {
  const auto stop_time_ns = to_nanoseconds(written_time(node));
  if (const auto problem = stop_time_problem(system, stop_time_ns)) node.fail(ErrorCode::invalid_value, *problem);
  system.stop_time_ns = stop_time_ns;
}

namespace {

std::vector<std::string> read_order(const Node& node, const SystemDescription& system) {
  std::vector<std::string> order;
  std::set<std::string> named;
  for (const auto& element : node.elements()) {
    element.attempt([&] {
      auto name = instance_name(element.text(), element, system);
      if (!named.insert(name).second) {
        element.fail(ErrorCode::duplicate_name, fmt::format("the instance '{}' is there twice", name));
      }
      order.push_back(std::move(name));
    });
  }
  std::vector<std::string> missing;
  for (const auto& name : system.instance_names()) {
    if (!named.contains(name)) missing.push_back(name);
  }
  if (!missing.empty()) {
    node.complain(ErrorCode::invalid_value,
                  fmt::format("the order must name every instance; missing: {}", fmt::join(missing, ", ")));
  }
  return order;
}

}  // namespace

void read_algorithm(const Node& node, SystemDescription& system) {
  auto& algorithm = system.algorithm;
  if (node.is(data::Kind::text)) {
    algorithm.type = node.text();
  } else {
    Object object(node);
    object.read("type", algorithm.type, &Node::text);
    object.read_if("order", algorithm.order, [&](const Node& order) { return read_order(order, system); });
    object.finish();
  }
  try {
    find_algorithm(algorithm);
  } catch (const InputError& error) {
    node.complain(error.code(), error.what());
  }
}

SolverDescription solver_description(const Node& node) {
  constexpr std::int64_t kMostSteps = 1'000'000'000;
  const auto positive = [](const Node& number) { return number.number(data::Limits::positive()); };
  Object object(node);
  SolverDescription solver;
  solver.place = node.place();
  object.comment("text");
  object.read_if("method", solver.method,
                 data::word_of<SolverMethod>({{"bdf", SolverMethod::bdf}, {"adams", SolverMethod::adams}}));
  object.read_if("relative_tolerance", solver.relative_tolerance, positive);
  object.read_if("absolute_tolerance", solver.absolute_tolerance, positive);
  object.read_if("max_step", solver.max_step_s, positive);
  object.read_if("max_steps", solver.max_steps, [&](const Node& number) { return number.whole_number(1, kMostSteps); });
  object.read_if("restart_at_points", solver.restarts_at_points, &Node::flag);
  object.finish();
  return solver;
}

void read_solver(const Node& node, SystemDescription& system) {
  system.solver = solver_description(node);
}

void read_threads(const Node& node, SystemDescription& system) {
  constexpr std::int64_t kMost = 256;
  if (node.is(data::Kind::text)) {
    system.threads = data::word_of<unsigned>({{"auto", kAutomaticThreads}})(node);
  } else {
    system.threads = static_cast<unsigned>(node.whole_number(1, kMost));
  }
}

void read_uncertainty(const Node& node, SystemDescription& system) {
  system.draws_calibration = data::word_of<bool>({{"calibration", true}})(node);
}

namespace {

double limit(const Node& node) {
  return node.number(data::Limits::positive());
}

BondDescription read_bond(const std::string& name, const Node& node, const SystemDescription& system) {
  Object object(node);
  BondDescription bond;
  bond.name = name;
  bond.place = node.place();
  object.comment("text");
  object.read("effort", bond.effort, variable_of(system));
  object.read("flow", bond.flow, variable_of(system));
  object.read_if("limit", bond.limit, &limit);
  object.finish();
  return bond;
}

}  // namespace

void read_coupling(const Node& node, SystemDescription& system) {
  Object object(node);
  CouplingDescription coupling;
  object.read_if("input_limit", coupling.input_limit, &limit);
  object.visit_if("bonds", [&](const Node& bonds) {
    for (const auto& [name, bond] : bonds.members()) {
      bond.attempt([&, &name = name, &bond = bond] { coupling.bonds.push_back(read_bond(name, bond, system)); });
    }
  });
  object.finish();
  system.coupling = std::move(coupling);
}

}  // namespace mebots::master::config
