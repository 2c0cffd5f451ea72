// SPDX-License-Identifier: Apache-2.0
//
// Reads any text as a modelDescription.xml of FMI 3.0. The reader must throw Error, or return a description with valid
// references, also after the replacement of arrays by their elements. The target links only the reader, because the
// checks and the archive code would take most of the time.
#include "mebots/error.hpp"
#include "mebots/modeldesc/array_elements.hpp"
#include "mebots/modeldesc/xml.hpp"

#include "require.hpp"

#include <cstdint>
#include <string_view>
#include <unordered_set>
#include <vector>

namespace {

using mebots::fuzz::require;
using mebots::modeldesc::ModelDescription;
using mebots::modeldesc::Unknown;

void require_sound(const ModelDescription& model) {
  for (const auto* unknowns :
       {&model.outputs, &model.derivatives, &model.initial_unknowns, &model.clocked_states, &model.event_indicators}) {
    for (const Unknown& unknown : *unknowns) {
      require(unknown.variable < model.variables.size(), "an unknown is a variable");
      if (!unknown.dependencies) continue;
      for (const auto dependency : *unknown.dependencies)
        require(dependency < model.variables.size(), "a dependency is a variable");
      require(unknown.dependency_kinds.empty() || unknown.dependency_kinds.size() == unknown.dependencies->size(),
              "each dependency has a kind, or none has");
    }
  }
  for (const auto& variable : model.variables) {
    require(!variable.derivative_of || *variable.derivative_of < model.variables.size(), "a state is a variable");
    if (!variable.fmi3->element) continue;
    require(variable.fmi3->element->index < variable.fmi3->element->count, "an element lies in its array");
    require(variable.fmi3->dimensions.empty(), "an element is no array");
  }
}

/// Returns false if one fuzz input would take seconds, because its arrays have too many elements.
bool is_small(const ModelDescription& model) {
  constexpr std::uint64_t kMost = 1000;
  std::uint64_t total = 0;
  for (const auto& variable : model.variables) {
    std::uint64_t count = 1;
    for (const auto size : sizes_of(model, variable)) {
      if (size > kMost) return false;
      count = count * size;
      if (count > kMost) return false;
    }
    total += count;
  }
  return total <= kMost;
}

/// Replaces arrays by their elements. The result must be sound, and each element must have a unique value reference.
void require_elements(const ModelDescription& model) {
  const auto elements = mebots::modeldesc::with_elements(model);
  require_sound(elements);
  std::unordered_set<std::uint32_t> references;
  for (const auto& variable : elements.variables) {
    const bool is_new = references.insert(variable.value_reference).second;
    require(is_new || !variable.fmi3->element, "an element has a reference of its own");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    const auto model = mebots::modeldesc::read_xml_text(text, "modelDescription.xml");
    require_sound(model);
    if (is_small(model)) require_elements(model);
  } catch (const mebots::Error&) {
  }
  return 0;
}
