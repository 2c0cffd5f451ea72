// SPDX-License-Identifier: Apache-2.0
#include "fmi3_instance.hpp"
#include "trace_file.hpp"

#include <algorithm>
#include <string>
#include <vector>

namespace mebots::check {
namespace {

/// Returns the numeric or Boolean variable with this name, or null.
const Fmi3Declared* find_number(const Fmi3Description& description, const std::string& name) {
  const auto found = std::ranges::find(description.variables(), name, &Fmi3Declared::name);
  if (found == description.variables().end()) return nullptr;
  const bool is_number = found->type != "String" && found->type != "Binary" && found->type != "Clock";
  return is_number ? &*found : nullptr;
}

}  // namespace

TraceScope fmi3_trace_scope(const Fmi3Target& target) {
  return trace_scope(find_traces(target.folder),
                     [&](const std::string& name) { return find_number(*target.description, name) != nullptr; });
}

void replay_trace(const Fmi3Library& library) {
  const auto& target = library.target();
  const auto& description = *target.description;
  const auto files = find_traces(target.folder).value();
  const auto is_number = [&](const std::string& name) { return find_number(description, name) != nullptr; };
  const auto outputs = read_trace(files.outputs, true, is_number);
  const auto inputs = read_inputs(files, is_number);
  Fmi3Instance instance(library, "replay");
  const bool reached = replay(
      library.witness(), files, inputs, outputs,
      {.enter_initialization = [&] { instance.enter_initialization(); },
       .exit_initialization = [&] { instance.exit_initialization(); },
       .set = [&](const std::string& name,
                  std::span<const double> values) { instance.set_numbers(*find_number(description, name), values); },
       .get = [&](const std::string& name) { return instance.get_numbers(*find_number(description, name)); },
       .step = [&](double time_s, double step_s) { instance.step(time_s, step_s); },
       .ended = [&] { return instance.ended(); },
       .is_real = [&](const std::string& name) { return find_number(description, name)->is_float(); }});
  if (reached) instance.terminate();
}

}  // namespace mebots::check
