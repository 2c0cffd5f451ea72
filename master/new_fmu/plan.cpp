// SPDX-License-Identifier: Apache-2.0
#include "new_fmu.hpp"

#include <algorithm>

namespace mebots::new_fmu {

using modeldesc::Causality;
using modeldesc::Field;
using modeldesc::FieldType;

Plan make_plan(const modeldesc::Description& description) {
  Plan plan;
  plan.description = &description;
  for (const Field& field : description.fields) {
    if (field.type != FieldType::real) continue;
    const bool usable = field.causality == Causality::parameter && field.unit == "s" && !field.group &&
                        !field.starts.empty() && std::get<double>(field.starts.front()) > 0;
    if (usable && plan.time_constant == nullptr) plan.time_constant = &field;
    if (field.causality != Causality::output) continue;
    Lag lag{&field, {}, {}};
    for (const Field& input : description.fields)
      if (input.type == FieldType::real && input.causality == Causality::input && input.unit == field.unit)
        lag.inputs.push_back(&input);
    for (std::size_t i = 0; i < field.fmi_names.size(); ++i) {
      // The default start value is zero, or the limit nearest to zero.
      const double zero =
          std::min(std::max(0.0, field.min.value_or(0)), std::max(field.max.value_or(0), field.min.value_or(0)));
      lag.rest.push_back(field.starts.empty() ? zero : std::get<double>(field.starts[i]));
    }
    plan.lags.push_back(std::move(lag));
  }
  return plan;
}

}  // namespace mebots::new_fmu
