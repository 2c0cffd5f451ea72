// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "run/run.hpp"

#include <nlohmann/json_fwd.hpp>

#include <string_view>

namespace mebots::master {

/// "instance.variable" looked up in a run that is started. Throws InputError with the nearest names.
ResolvedVariable find_variable(const Run& run, std::string_view name);

/// Sets an input that nothing is connected to, or a tunable parameter, from the next step on, as a program or a person
/// does while the run stands between two steps. summary.json tells it under `inputs.writes`. `place` says who asks, for
/// errors. Returns the value as the variable's type has it. Throws InputError for a variable that cannot be set, and
/// for a value that it does not take.
modeldesc::Value write_variable(Run& run, std::string_view name, double value, const std::string& place);

/// What write_variable() takes: [{"variable", "unit", "text", "type"}], in the order of instances and descriptions.
nlohmann::ordered_json writable_variables(const ResolvedSystem& system);

}  // namespace mebots::master
