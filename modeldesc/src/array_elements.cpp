// SPDX-License-Identifier: Apache-2.0
#include "mebots/modeldesc/array_elements.hpp"

#include "mebots/error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <unordered_set>

namespace mebots::modeldesc {
namespace {

std::uint64_t value_of(const ModelDescription& description, std::uint32_t reference, const StructuralValues& values) {
  if (const auto given = values.find(reference); given != values.end()) return given->second;
  const auto found = std::ranges::find(description.variables, reference, &Variable::value_reference);
  if (found == description.variables.end()) return 0;
  const auto* start = std::get_if<std::int64_t>(&found->start);
  return start == nullptr ? 0 : static_cast<std::uint64_t>(*start);
}

/// Returns the product of the sizes. If it exceeds kMostElements, returns kMostElements + 1.
std::size_t count_of(const std::vector<std::uint64_t>& sizes) {
  std::size_t count = 1;
  for (const auto size : sizes) {
    if (size > kMostElements || count * size > kMostElements) return kMostElements + 1;
    count *= size;
  }
  return count;
}

}  // namespace

std::string element_name(const std::string& array, const std::vector<std::uint64_t>& sizes, std::size_t index) {
  std::vector<std::size_t> places(sizes.size());
  for (std::size_t i = sizes.size(); i-- > 0;) {
    places[i] = index % sizes[i] + 1;
    index /= sizes[i];
  }
  return fmt::format("{}[{}]", array, fmt::join(places, ","));
}

namespace {

/// Returns unused value references in ascending order, from the middle of the value range.
class FreeReferences {
 public:
  explicit FreeReferences(const ModelDescription& description) {
    for (const auto& variable : description.variables) used_.insert(variable.value_reference);
  }
  std::uint32_t next() {
    while (used_.contains(next_)) ++next_;
    return next_++;
  }

 private:
  std::unordered_set<std::uint32_t> used_;
  std::uint32_t next_ = 0x80000000U;
};

/// Replaces arrays by their elements and records the new index of each variable.
class Expansion {
 public:
  Expansion(const ModelDescription& description, const StructuralValues& values)
      : description_(&description), values_(&values), free_(description) {}

  ModelDescription run() {
    ModelDescription result = *description_;
    result.variables.clear();
    for (const auto& variable : description_->variables) {
      places_.push_back({result.variables.size(), 1});
      add(variable, result.variables);
      places_.back().count = result.variables.size() - places_.back().first;
      if (result.variables.size() > kMostElements + description_->variables.size())
        throw Error(ErrorCode::value_out_of_range, fmt::format("\"{}\": the arrays have more than {} elements in total",
                                                               variable.name, kMostElements));
    }
    check_derivatives();
    for (auto& variable : result.variables) {
      if (variable.derivative_of) variable.derivative_of = state_of(variable);
    }
    for (auto* list : {&result.outputs, &result.derivatives, &result.initial_unknowns, &result.clocked_states,
                       &result.event_indicators}) {
      *list = moved(*list);
    }
    result.number_of_event_indicators = static_cast<std::uint32_t>(result.event_indicators.size());
    result.index_names();
    return result;
  }

 private:
  struct Place {
    std::size_t first;
    std::size_t count;
  };

  void add(const Variable& variable, std::vector<Variable>& list) {
    if (variable.fmi3->dimensions.empty()) {
      list.push_back(variable);
      return;
    }
    const auto sizes = sizes_of(*description_, variable, *values_);
    const auto count = count_of(sizes);
    if (count > kMostElements)
      throw Error(ErrorCode::value_out_of_range, fmt::format("the array \"{}\" has the sizes {}: more than {} elements",
                                                             variable.name, fmt::join(sizes, " x "), kMostElements));
    const auto& starts = variable.fmi3->starts;
    for (std::size_t i = 0; i < count; ++i) {
      Variable element = variable;
      Fmi3Part part = *variable.fmi3;
      part.dimensions.clear();
      part.starts.clear();
      part.element = ArrayElement{variable.name, variable.value_reference, i, count};
      element.name = element_name(variable.name, sizes, i);
      element.value_reference = free_.next();
      if (starts.size() == count) element.start = starts[i];
      element.fmi3 = std::move(part);
      list.push_back(std::move(element));
    }
  }

  void check_derivatives() const {
    const auto& variables = description_->variables;
    for (std::size_t i = 0; i < variables.size(); ++i) {
      if (!variables[i].derivative_of) continue;
      const auto state = *variables[i].derivative_of;
      if (places_[i].count == places_[state].count) continue;
      throw Error(ErrorCode::fmu_inconsistent,
                  fmt::format("\"{}\" is the derivative of \"{}\", but has {} elements, and the state has {}",
                              variables[i].name, variables[state].name, places_[i].count, places_[state].count));
    }
  }

  /// Returns the index of the state that belongs to `derivative`. If both are elements of arrays, they have the same
  /// index in their arrays.
  std::size_t state_of(const Variable& derivative) const {
    const auto& place = places_[*derivative.derivative_of];
    return place.first + (derivative.fmi3->element ? derivative.fmi3->element->index : 0);
  }

  void count_dependencies(const Unknown& unknown, const Unknown& element, std::size_t elements) {
    if (!element.dependencies) return;
    dependencies_ += element.dependencies->size() * elements;
    if (dependencies_ <= kMostDependencies) return;
    throw Error(
        ErrorCode::value_out_of_range,
        fmt::format("\"{}\": the elements of the arrays have more than {} dependencies in total. Choose smaller "
                    "sizes, or leave out \"dependencies\" in modelDescription.xml",
                    description_->variables[unknown.variable].name, kMostDependencies));
  }

  std::vector<Unknown> moved(const std::vector<Unknown>& unknowns) {
    std::vector<Unknown> result;
    for (const auto& unknown : unknowns) {
      Unknown one;
      if (unknown.dependencies) {
        one.dependencies.emplace();
        for (std::size_t i = 0; i < unknown.dependencies->size(); ++i) {
          const auto& place = places_[(*unknown.dependencies)[i]];
          for (std::size_t k = 0; k < place.count; ++k) {
            one.dependencies->push_back(place.first + k);
            if (!unknown.dependency_kinds.empty()) one.dependency_kinds.push_back(unknown.dependency_kinds[i]);
          }
        }
      }
      const auto& place = places_[unknown.variable];
      count_dependencies(unknown, one, place.count);
      for (std::size_t k = 0; k < place.count; ++k) {
        one.variable = place.first + k;
        result.push_back(one);
      }
    }
    return result;
  }

  const ModelDescription* description_;
  const StructuralValues* values_;
  FreeReferences free_;
  std::vector<Place> places_;
  std::size_t dependencies_ = 0;
};

}  // namespace

std::vector<std::uint64_t> sizes_of(const ModelDescription& description, const Variable& variable,
                                    const StructuralValues& values) {
  std::vector<std::uint64_t> sizes;
  for (const auto& dimension : variable.fmi3->dimensions) {
    sizes.push_back(dimension.start ? *dimension.start : value_of(description, *dimension.value_reference, values));
  }
  return sizes;
}

ModelDescription with_elements(const ModelDescription& description, const StructuralValues& values) {
  const auto is_array = [](const Variable& variable) { return !variable.fmi3->dimensions.empty(); };
  if (std::ranges::none_of(description.variables, is_array)) return description;
  return Expansion(description, values).run();
}

}  // namespace mebots::modeldesc
