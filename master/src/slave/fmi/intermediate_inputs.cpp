// SPDX-License-Identifier: Apache-2.0
#include "slave/fmi/intermediate_inputs.hpp"

#include "slave/extrapolation.hpp"

#include <algorithm>
#include <utility>

namespace mebots::master {
namespace {

using modeldesc::Causality;
using modeldesc::Type;
using modeldesc::Variability;

bool is_intermediate(const modeldesc::Variable& variable) {
  return variable.causality == Causality::input && variable.variability == Variability::continuous &&
         variable.type == Type::real && variable.fmi3->intermediate_update && variable.fmi3->clocks.empty();
}

}  // namespace

IntermediateInputs::IntermediateInputs(const modeldesc::ModelDescription& model) {
  if (!model.co_simulation || !model.co_simulation->provides_intermediate_update) return;
  for (const auto& variable : model.variables) {
    if (!is_intermediate(variable)) continue;
    const auto& element = variable.fmi3->element;
    const auto reference = element ? element->array_reference : variable.value_reference;
    auto whole = std::ranges::find(wholes_, reference, &Whole::reference);
    if (whole == wholes_.end()) whole = wholes_.insert(whole, {reference, {}});
    whole->elements.push_back(variable.value_reference);
    elements_.insert(variable.value_reference);
  }
}

std::vector<std::uint32_t> IntermediateInputs::references() const {
  std::vector<std::uint32_t> references;
  for (const auto& whole : wholes_) references.push_back(whole.reference);
  return references;
}

void IntermediateInputs::begin_point() {
  if (std::exchange(has_stepped_, false)) courses_.clear();
}

void IntermediateInputs::set(std::span<const ValueReference> references, std::span<const double> values) {
  begin_point();
  for (std::size_t i = 0; i < references.size(); ++i) {
    if (elements_.contains(references[i])) courses_[references[i]] = {.value = values[i]};
  }
}

void IntermediateInputs::set_derivatives(std::span<const ValueReference> references,
                                         std::span<const std::int32_t> orders, std::span<const double> values) {
  begin_point();
  for (std::size_t i = 0; i < references.size(); ++i) {
    const auto course = courses_.find(references[i]);
    if (course == courses_.end()) continue;
    auto& derivatives = course->second.derivatives;
    const auto order = static_cast<std::size_t>(orders[i]);
    derivatives.resize(std::max(derivatives.size(), order), 0.0);
    derivatives[order - 1] = values[i];
  }
}

void IntermediateInputs::start_step(double start_s) {
  if (!std::exchange(has_stepped_, true)) start_s_ = start_s;
}

std::pair<std::vector<std::uint32_t>, std::vector<double>> IntermediateInputs::values_at(double time_s) const {
  std::pair<std::vector<std::uint32_t>, std::vector<double>> result;
  auto& [references, values] = result;
  for (const auto& whole : wholes_) {
    const auto is_set = [&](auto element) { return courses_.contains(element); };
    const auto moves = [&](auto element) { return !courses_.at(element).derivatives.empty(); };
    if (!std::ranges::all_of(whole.elements, is_set) || std::ranges::none_of(whole.elements, moves)) continue;
    references.push_back(whole.reference);
    for (const auto element : whole.elements) {
      const auto& course = courses_.at(element);
      values.push_back(extrapolated(course.value, course.derivatives, time_s - start_s_));
    }
  }
  return result;
}

}  // namespace mebots::master
