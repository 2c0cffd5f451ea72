// SPDX-License-Identifier: Apache-2.0
#include "mebots/modeldesc/model_description.hpp"

#include <cmath>

namespace mebots::modeldesc {

std::optional<double> DefaultExperiment::usable_tolerance() const {
  return tolerance && std::isfinite(*tolerance) && *tolerance > 0 ? tolerance : std::nullopt;
}

void ModelDescription::index_names() {
  variable_index.build(variables);
  unit_index.build(units);
  type_index.build(types);
}

}  // namespace mebots::modeldesc
