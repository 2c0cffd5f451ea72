// SPDX-License-Identifier: Apache-2.0
#include "mebots/modeldesc/model_description.hpp"

namespace mebots::modeldesc {

void ModelDescription::index_names() {
  variable_index.build(variables);
  unit_index.build(units);
  type_index.build(types);
}

}  // namespace mebots::modeldesc
