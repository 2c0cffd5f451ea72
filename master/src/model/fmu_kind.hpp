// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/model_description.hpp"

#include <cstdint>
#include <string_view>

namespace mebots::master {

enum class FmuKind : std::uint8_t {
  co_simulation,   ///< the FMU contains its own solver
  model_exchange,  ///< a solver of the master integrates the FMU's equations
};

/// Returns the name of the kind in a config ("co_simulation") or in modelDescription.xml ("CoSimulation").
constexpr std::string_view word_of(FmuKind kind) {
  return kind == FmuKind::co_simulation ? "co_simulation" : "model_exchange";
}
constexpr std::string_view element_of(FmuKind kind) {
  return kind == FmuKind::co_simulation ? "CoSimulation" : "ModelExchange";
}

/// Returns the content of <CoSimulation> or <ModelExchange> in modelDescription.xml; null if the FMU has no such
/// element.
inline const modeldesc::Implementation* implementation_of(const modeldesc::ModelDescription& model, FmuKind kind) {
  if (kind == FmuKind::co_simulation) return model.co_simulation ? &*model.co_simulation : nullptr;
  return model.model_exchange ? &*model.model_exchange : nullptr;
}

}  // namespace mebots::master
