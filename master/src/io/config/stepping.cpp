// SPDX-License-Identifier: Apache-2.0
// Reads `text`, `step`, `start_time`, `stop_time`, `algorithm`, `step_control`, `solver`, `coupling` and `threads`.
#include "mebots/input_error.hpp"
#include "sections.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <set>

namespace mebots::master::config {

void read_text(const Node& node, SystemDescription& /*system*/) {
  static_cast<void>(node.text());  // the text is only for readers of the file
}

void read_step(const Node& node, SystemDescription& system) {
  const auto step = step_time(node);
  if (node.kind() != data::Kind::text && !step.is_whole_nanoseconds()) {
    system.notices.push_back(
        fmt::format("{}: the step {} s is read as {} s", node.place(), node.shown(), time_text(step)));
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

double positive_number(const Node& node) {
  return node.number(data::Limits::positive());
}

std::vector<std::string> read_order(const Node& node, const SystemDescription& system) {
  std::vector<std::string> order;
  std::set<std::string> named;
  for (const auto& element : node.elements()) {
    element.attempt([&] {
      auto name = instance_name(element.text(), element, system);
      if (!named.insert(name).second) {
        element.fail(ErrorCode::duplicate_name, fmt::format("the instance '{}' occurs twice", name));
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

namespace {

CouplingTolerance read_tolerance(const Node& node, const CouplingTolerance& general) {
  auto tolerance = general;
  Object object(node);
  object.read_if("relative", tolerance.relative, positive_number);
  object.read_if("absolute", tolerance.absolute, positive_number);
  object.finish();
  return tolerance;
}

NamedTolerance read_named_tolerance(const std::string& name, const Node& node, const CouplingTolerance& general) {
  NamedTolerance named{.name = name, .tolerance = {}, .place = node.place()};
  if (!node.is(data::Kind::boolean)) {
    named.tolerance = read_tolerance(node, general);
  } else if (node.flag()) {
    named.tolerance = general;
  }
  return named;
}

void read_controller(Object& object, StepControlDescription& control) {
  const auto within = [](double least, double most) { return data::number(data::Limits::between(least, most)); };
  constexpr double kMostFactor = 100;
  object.read_if("safety", control.safety, within(0.01, 1));
  object.read_if("min_factor", control.min_factor, within(0.001, 1));
  object.read_if("max_factor", control.max_factor, within(1, kMostFactor));
  object.read_if("proportional_gain", control.proportional_gain, within(0, 1));
  object.read_if("integral_gain", control.integral_gain, within(0, 1));
}

void check_order(const Node& node, const StepControlDescription& control, const SystemDescription& system) {
  const auto text = [&](std::int64_t steps) { return time_text(system.length_of(steps)); };
  if (control.min_steps > control.max_steps) {
    node.complain(ErrorCode::invalid_value, fmt::format("\"min_step\" {} s is longer than \"max_step\" {} s",
                                                        text(control.min_steps), text(control.max_steps)));
  } else if (control.initial_steps < control.min_steps || control.initial_steps > control.max_steps) {
    node.complain(ErrorCode::invalid_value,
                  fmt::format("\"initial_step\" {} s is not between \"min_step\" {} s and \"max_step\" {} s",
                              text(control.initial_steps), text(control.min_steps), text(control.max_steps)));
  }
}

}  // namespace

void read_step_control(const Node& node, SystemDescription& system) {
  const auto steps = [&](const Node& member) { return steps_in(member, system); };
  StepControlDescription control;
  control.place = node.place();
  Object object(node);
  object.comment("text");
  object.read("max_step", control.max_steps, steps);
  object.read_if("min_step", control.min_steps, steps);
  control.initial_steps = control.min_steps;
  object.read_if("initial_step", control.initial_steps, steps);
  object.read_if("relative_tolerance", control.tolerance.relative, positive_number);
  object.read_if("absolute_tolerance", control.tolerance.absolute, positive_number);
  object.visit_if("tolerances", [&](const Node& tolerances) {
    for (const auto& [name, tolerance] : tolerances.members()) {
      tolerance.attempt([&, &name = name, &tolerance = tolerance] {
        control.tolerances.push_back(read_named_tolerance(name, tolerance, control.tolerance));
      });
    }
  });
  object.read_if(
      "rollback", control.rollback,
      data::word_of<Rollback>(
          {{"never", Rollback::never}, {"if_possible", Rollback::if_possible}, {"required", Rollback::required}}));
  read_controller(object, control);
  object.finish();
  if (object.sound()) check_order(node, control, system);
  system.step_control = std::move(control);
}

SolverDescription solver_description(const Node& node) {
  constexpr std::int64_t kMostSteps = 1'000'000'000;
  Object object(node);
  SolverDescription solver;
  solver.place = node.place();
  object.comment("text");
  object.read_if("method", solver.method,
                 data::word_of<SolverMethod>({{"bdf", SolverMethod::bdf}, {"adams", SolverMethod::adams}}));
  object.read_if("relative_tolerance", solver.relative_tolerance, positive_number);
  object.read_if("absolute_tolerance", solver.absolute_tolerance, positive_number);
  object.read_if("max_step", solver.max_step_s, positive_number);
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

BondDescription read_bond(const std::string& name, const Node& node, const SystemDescription& system) {
  Object object(node);
  BondDescription bond;
  bond.name = name;
  bond.place = node.place();
  object.comment("text");
  object.read("effort", bond.effort, variable_of(system));
  object.read("flow", bond.flow, variable_of(system));
  object.read_if("limit", bond.limit, positive_number);
  object.finish();
  return bond;
}

}  // namespace

void read_coupling(const Node& node, SystemDescription& system) {
  Object object(node);
  CouplingDescription coupling;
  object.read_if("input_limit", coupling.input_limit, positive_number);
  object.visit_if("bonds", [&](const Node& bonds) {
    for (const auto& [name, bond] : bonds.members()) {
      bond.attempt([&, &name = name, &bond = bond] { coupling.bonds.push_back(read_bond(name, bond, system)); });
    }
  });
  object.finish();
  system.coupling = std::move(coupling);
}

}  // namespace mebots::master::config
