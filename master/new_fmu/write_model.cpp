// SPDX-License-Identifier: Apache-2.0
#include "new_fmu.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace mebots::new_fmu {
namespace {

using modeldesc::Field;

std::string member(const Field& field) {
  return field.cpp_name + "_";
}

/// Returns a C++ expression for the value that an output approaches: the sum of its inputs. If the output is an array,
/// this is the expression for element `i`.
std::string target(const Plan& plan, const Lag& lag) {
  std::string text;
  for (const Field* input : lag.inputs) {
    const bool same_group = lag.output->group && input->group == lag.output->group;
    const auto value = fmt::format("inputs.{}", input->cpp_name);
    text += (text.empty() ? "" : " + ") + (same_group              ? value + "[i]"
                                           : plan.is_group(*input) ? fmt::format("sum({})", value)
                                                                   : value);
  }
  return text;
}

/// Returns code that opens the description's namespace, or an empty text.
std::string opened_namespace(const modeldesc::Description& description) {
  return description.cpp_namespace.empty() ? "" : fmt::format("namespace {} {{\n\n", description.cpp_namespace);
}

std::string closed_namespace(const modeldesc::Description& description) {
  return description.cpp_namespace.empty() ? "" : fmt::format("\n}}  // namespace {}\n", description.cpp_namespace);
}

bool needs_sum(const Plan& plan) {
  return std::ranges::any_of(plan.lags, [](const Lag& lag) {
    return std::ranges::any_of(lag.inputs,
                               [&](const Field* input) { return input->group && input->group != lag.output->group; });
  });
}

bool has_driven(const Plan& plan) {
  return std::ranges::any_of(plan.lags, [](const Lag& lag) { return !lag.inputs.empty(); });
}

}  // namespace

std::string model_header(const Plan& plan) {
  const auto& d = *plan.description;
  std::string members;
  for (const Lag& lag : plan.lags) {
    if (lag.output->group)
      members += fmt::format("  std::array<double, {}::kCount> {} = {{{}}};\n", plan.group(*lag.output),
                             member(*lag.output), fmt::join(lag.rest, ", "));
    else
      members += fmt::format("  double {} = {};\n", member(*lag.output), lag.rest.front());
  }
  return fmt::format(R"(// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "{name}/variables.hpp"
#include "mebots/state/visitor.hpp"

#include <array>
#include <cstdint>
#include <filesystem>

{open}/// {text}.
///
/// Every Real output y follows the sum u of the Real inputs of its unit with one time constant T:
///
///     T dy/dt = u - y,  so for inputs held over h:  y(t + h) = u + (y(t) - u) exp(-h / T)
///
/// An output without such an input stays where it starts, and so do outputs of other types.
class Model {{
 public:
  /// Throws mebots::Error for a parameter that makes no sense. `resources` holds the files that travel in the FMU.
  Model(const Parameters& parameters, const std::filesystem::path& resources);

  /// Writes the outputs at the start.
  void start(const Inputs& inputs, Outputs& outputs);
  /// Moves on by duration_ns > 0 with the inputs held.
  void step(const Inputs& inputs, std::int64_t duration_ns, Outputs& outputs);

  /// Shows everything that a later step depends on.
  void visit(mebots::state::Visitor& visitor);

 private:
  void write(Outputs& outputs) const;

  double time_constant_s_;
{members}}};
{close})",
                     fmt::arg("name", d.name), fmt::arg("open", opened_namespace(d)),
                     fmt::arg("close", closed_namespace(d)), fmt::arg("text", d.text), fmt::arg("members", members));
}

std::string model_source(const Plan& plan) {
  const auto& d = *plan.description;
  std::string step;
  std::string write;
  std::string visit;
  for (const Lag& lag : plan.lags) {
    const auto name = member(*lag.output);
    write += fmt::format("  outputs.{} = {};\n", lag.output->cpp_name, name);
    visit += fmt::format("  visitor(\"{}\", {});\n", lag.output->cpp_name, name);
    if (lag.inputs.empty()) continue;
    if (lag.output->group)
      step += fmt::format("  for (std::size_t i = 0; i < {}::kCount; ++i) {}[i] = follow({}[i], {}, kept);\n",
                          plan.group(*lag.output), name, name, target(plan, lag));
    else
      step += fmt::format("  {} = follow({}, {}, kept);\n", name, name, target(plan, lag));
  }
  std::string helpers;
  if (has_driven(plan))
    helpers += R"(
/// Where y is after the step: `kept` is the part of its distance to the target that is left.
double follow(double y, double target, double kept) {
  return target + (y - target) * kept;
}
)";
  if (needs_sum(plan))
    helpers += R"(
template <std::size_t N>
double sum(const std::array<double, N>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}
)";
  std::string constructor;
  if (plan.time_constant != nullptr)
    constructor = fmt::format(R"(Model::Model(const Parameters& parameters, const std::filesystem::path& /*resources*/)
    : time_constant_s_(parameters.{field}) {{
  if (!(time_constant_s_ > 0))
    throw mebots::Error(fmt::format("{variable} = {{}} s: a time constant above 0 is needed", time_constant_s_));
}}
)",
                              fmt::arg("field", plan.time_constant->cpp_name),
                              fmt::arg("variable", plan.time_constant->fmi_names.front()));
  else
    constructor = R"(Model::Model(const Parameters& /*parameters*/, const std::filesystem::path& /*resources*/)
    : time_constant_s_(kTimeConstant_s) {}
)";
  const std::string constants = plan.time_constant != nullptr
                                    ? ""
                                    : "\n/// Time constant of all outputs; the description declares no parameter for "
                                      "it.\nconstexpr double kTimeConstant_s = 1;\n";
  const std::string anonymous = helpers.empty() && constants.empty()
                                    ? ""
                                    : fmt::format("namespace {{\n{}{}\n}}  // namespace\n\n", constants, helpers);
  const bool driven = has_driven(plan);
  return fmt::format(
      R"(// SPDX-License-Identifier: Apache-2.0
#include "model.hpp"

#include "mebots/error.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numeric>

{open}{anonymous}{constructor}
void Model::start(const Inputs& /*inputs*/, Outputs& outputs) {{
  write(outputs);
}}

void Model::step(const Inputs& {inputs}, std::int64_t {duration}, Outputs& outputs) {{
{kept}{step}  write(outputs);
}}

void Model::write(Outputs& {outputs}) const {{
{write}}}

void Model::visit(mebots::state::Visitor& {visitor}) {{
{visit}}}
{close})",
      fmt::arg("open", opened_namespace(d)), fmt::arg("close", closed_namespace(d)), fmt::arg("anonymous", anonymous),
      fmt::arg("constructor", constructor), fmt::arg("inputs", driven ? "inputs" : "/*inputs*/"),
      fmt::arg("duration", driven ? "duration_ns" : "/*duration_ns*/"),
      fmt::arg("kept",
               driven ? "  const double kept = std::exp(-1e-9 * static_cast<double>(duration_ns) / time_constant_s_);\n"
                      : ""),
      fmt::arg("step", step), fmt::arg("outputs", write.empty() ? "/*outputs*/" : "outputs"), fmt::arg("write", write),
      fmt::arg("visitor", visit.empty() ? "/*visitor*/" : "visitor"), fmt::arg("visit", visit));
}

std::string binding_source(const Plan& plan) {
  return fmt::format(R"(// SPDX-License-Identifier: Apache-2.0
#include "{name}/binding.hpp"
#include "mebots/fmu/bound_model.hpp"
#include "model.hpp"

{open}std::unique_ptr<mebots::fmu::Model> make_model(Variables& variables, mebots::fmu::Host& host, std::int64_t start_ns) {{
  return std::make_unique<mebots::fmu::BoundModel<Model, Variables>>(variables, host, start_ns);
}}
{close})",
                     fmt::arg("name", plan.description->name), fmt::arg("open", opened_namespace(*plan.description)),
                     fmt::arg("close", closed_namespace(*plan.description)));
}

std::string test_source(const Plan& plan) {
  const auto& d = *plan.description;
  std::string rests;
  std::string same;
  for (const Lag& lag : plan.lags) {
    const bool array = lag.output->group.has_value();
    for (std::size_t i = 0; i < lag.rest.size(); ++i) {
      const auto value = fmt::format("outputs.{}{}", lag.output->cpp_name, array ? fmt::format("[{}]", i) : "");
      rests += fmt::format("  EXPECT_EQ(bench.{}, {});\n", value, lag.rest[i]);
    }
    same += fmt::format("  EXPECT_EQ(a.{0}, b.{0});\n", lag.output->cpp_name);
  }
  const auto driven = std::ranges::find_if(plan.lags, [](const Lag& lag) {
    return !lag.inputs.empty() && !lag.output->group && !lag.inputs.front()->group;
  });
  std::string follows;
  if (driven != plan.lags.end()) {
    const auto& input = *driven->inputs.front();
    const double least = input.min.value_or(input.max.value_or(2) - 2);
    const double value = input.max ? 0.5 * (least + *input.max) : least + 1;
    std::string others;
    for (const Field* other : driven->inputs)
      others += fmt::format(
          "{}{}", others.empty() ? "" : " + ",
          other->group
              ? fmt::format("std::accumulate(bench.inputs.{0}.begin(), bench.inputs.{0}.end(), 0.0)", other->cpp_name)
              : "bench.inputs." + other->cpp_name);
    follows = fmt::format(R"(
TEST(Model, FollowsItsInputsWithItsTimeConstant) {{
  Bench bench;
  bench.inputs.{input} = {value};
  const double target = {target};
  const double before = bench.outputs.{output};
  bench.model.step(bench.inputs, bench.time_constant_ns, bench.outputs);
  // The step is the exact solution: only rounding is left.
  EXPECT_NEAR(bench.outputs.{output}, target + (before - target) * std::exp(-1.0), 1e-12 * (1 + std::abs(target)));
}}
)",
                          fmt::arg("input", input.cpp_name), fmt::arg("value", value), fmt::arg("target", others),
                          fmt::arg("output", driven->output->cpp_name));
  }
  const auto time_constant = plan.time_constant == nullptr
                                 ? std::string("1'000'000'000")
                                 : fmt::format("std::llround(1e9 * parameters.{})", plan.time_constant->cpp_name);
  return fmt::format(R"(// SPDX-License-Identifier: Apache-2.0
#include "mebots/state/save.hpp"
#include "model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

{open}namespace {{

struct Bench {{
  Bench() : model(parameters, ".") {{ model.start(inputs, outputs); }}

  Parameters parameters;
  Inputs inputs;
  Outputs outputs;
  Model model;
  std::int64_t time_constant_ns = {time_constant};
}};

TEST(Model, StartsAtRest) {{
  const Bench bench;
{rests}}}
{follows}
TEST(Model, SavedStateContinuesAsTheStraightRun) {{
  Bench straight;
  Bench restored;
  straight.model.step(straight.inputs, 10'000'000, straight.outputs);
  const auto saved = mebots::state::save(straight.model);
  straight.model.step(straight.inputs, 10'000'000, straight.outputs);
  mebots::state::restore(restored.model, saved);
  restored.model.step(restored.inputs, 10'000'000, restored.outputs);
  [[maybe_unused]] const auto& a = straight.outputs;
  [[maybe_unused]] const auto& b = restored.outputs;
{same}}}

}}  // namespace
{close})",
                     fmt::arg("open", opened_namespace(d)), fmt::arg("close", closed_namespace(d)),
                     fmt::arg("time_constant", time_constant), fmt::arg("rests", rests), fmt::arg("follows", follows),
                     fmt::arg("same", same));
}

}  // namespace mebots::new_fmu
