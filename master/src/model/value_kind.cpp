// SPDX-License-Identifier: Apache-2.0
#include "model/value_kind.hpp"

#include <algorithm>

namespace mebots::master {

std::string whole_text(modeldesc::Type type, std::int64_t value) {
  return type == modeldesc::Type::uint64 ? std::to_string(static_cast<std::uint64_t>(value)) : std::to_string(value);
}

bool is_osmp_part(const modeldesc::ModelDescription& description, const modeldesc::Variable& variable) {
  if (variable.osmp) return true;
  if (variable.type != modeldesc::Type::integer) return false;
  for (const auto* ending : kOsmpEndings) {
    if (!variable.name.ends_with(ending)) continue;
    const auto prefix = variable.name.substr(0, variable.name.size() - std::string_view(ending).size());
    return std::all_of(std::begin(kOsmpEndings), std::end(kOsmpEndings), [&](const char* other) {
      const auto* part = description.find(prefix + other);
      return part != nullptr && part->type == modeldesc::Type::integer && part->causality == variable.causality;
    });
  }
  return false;
}

std::vector<OsmpTriple> osmp_triples(const modeldesc::ModelDescription& description) {
  std::vector<OsmpTriple> triples;
  const std::string_view first_ending = kOsmpEndings[0];
  for (const auto& variable : description.variables) {
    if (!variable.name.ends_with(first_ending) || !is_osmp_part(description, variable)) continue;
    const auto prefix = variable.name.substr(0, variable.name.size() - first_ending.size());
    OsmpTriple triple{};
    bool whole = true;
    for (std::size_t i = 0; i < triple.references.size(); ++i) {
      const auto* part = description.find(prefix + kOsmpEndings[i]);
      whole = whole && part != nullptr;
      if (part != nullptr) triple.references[i] = part->value_reference;
    }
    if (whole) triples.push_back(triple);
  }
  return triples;
}

std::optional<std::array<std::size_t, 3>> places_of(const OsmpTriple& triple,
                                                    std::span<const ValueReference> references) {
  std::array<std::size_t, 3> places{};
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto found = std::find(references.begin(), references.end(), triple.references[i]);
    if (found == references.end()) return std::nullopt;
    places[i] = static_cast<std::size_t>(found - references.begin());
  }
  return places;
}

}  // namespace mebots::master
