// SPDX-License-Identifier: Apache-2.0
#include "new_fmu.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace mebots::new_fmu {
namespace {

using modeldesc::Causality;
using modeldesc::Field;
using modeldesc::FieldType;

/// Returns a name as a CSV cell.
std::string cell(const std::string& name) {
  if (name.find_first_of(",\"") == std::string::npos) return name;
  std::string quoted = "\"";
  for (const char c : name) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

/// Returns an example value for an input: the middle of its limits, one limit plus or minus 1, or 1 without limits.
double example_value(const Field& input) {
  const double least = input.min.value_or(input.max.value_or(2) - 2);
  return input.max ? 0.5 * (least + *input.max) : least + 1;
}

/// Returns the constant values of Real inputs in the example case.
std::map<const Field*, std::vector<double>> held_inputs(const Plan& plan) {
  std::map<const Field*, std::vector<double>> held;
  for (const Field& field : plan.description->fields) {
    if (field.causality != Causality::input || field.type != FieldType::real) continue;
    held[&field] = std::vector<double>(field.fmi_names.size(), example_value(field));
  }
  return held;
}

double target_of(const Lag& lag, std::size_t element, const std::map<const Field*, std::vector<double>>& held) {
  double target = 0;
  for (const Field* input : lag.inputs) {
    const auto& values = held.at(input);
    const bool same_group = lag.output->group && input->group == lag.output->group;
    target += same_group ? values[element] : std::accumulate(values.begin(), values.end(), 0.0);
  }
  return target;
}

std::string inputs_text(const Plan& plan) {
  const auto held = held_inputs(plan);
  std::string header = "time";
  std::string row;
  for (const Field& field : plan.description->fields) {
    const auto found = held.find(&field);
    if (found == held.end()) continue;
    for (std::size_t i = 0; i < field.fmi_names.size(); ++i) {
      header += "," + cell(field.fmi_names[i]);
      row += fmt::format(",{}", found->second[i]);
    }
  }
  return fmt::format("{}\n0{}\n", header, row);
}

/// Returns the exact solution after 0, 1 and 10 steps as CSV text.
std::string expected_text(const Plan& plan, double step_s) {
  const auto held = held_inputs(plan);
  const double time_constant_s =
      plan.time_constant == nullptr ? 1 : std::get<double>(plan.time_constant->starts.front());
  std::string text = "time";
  for (const Lag& lag : plan.lags) {
    for (const auto& name : lag.output->fmi_names) text += "," + cell(name);
  }
  text += '\n';
  for (const int steps : {0, 1, 10}) {
    const double time_s = steps * step_s;
    text += fmt::format("{}", time_s);
    for (const Lag& lag : plan.lags) {
      for (std::size_t i = 0; i < lag.rest.size(); ++i) {
        const double target = lag.inputs.empty() ? lag.rest[i] : target_of(lag, i, held);
        text += fmt::format(",{}", target + (lag.rest[i] - target) * std::exp(-time_s / time_constant_s));
      }
    }
    text += '\n';
  }
  return text;
}

}  // namespace

Files case_files(const Plan& plan) {
  if (plan.lags.empty()) return {};  // without Real outputs, there is nothing to compare
  const auto& d = *plan.description;
  const bool has_inputs = !held_inputs(plan).empty();
  const auto cases = fmt::format(R"({{
  "text": "Unit tests of {name}: mebots test build/fmus/{name}.fmu test/{name}.mebots-test.json",
  "fmu": "../build/fmus/{name}.fmu",
  "tolerance": {{"absolute": 1e-9, "relative": 1e-6}},
  "cases": {{
    "first": {{"text": "The outputs follow inputs that are held", {inputs}"expected": "first_out.csv", "step": {step}}}
  }}
}}
)",
                                 fmt::arg("name", d.name), fmt::arg("step", d.step_s),
                                 fmt::arg("inputs", has_inputs ? R"("inputs": "first_in.csv", )" : ""));
  Files files = {{fmt::format("test/{}.mebots-test.json", d.name), cases},
                 {"test/first_out.csv", expected_text(plan, d.step_s)}};
  if (has_inputs) files.emplace_back("test/first_in.csv", inputs_text(plan));
  return files;
}

}  // namespace mebots::new_fmu
