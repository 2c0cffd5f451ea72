// SPDX-License-Identifier: Apache-2.0
#include "fmi3_instance.hpp"
#include "trace_file.hpp"

#include "mebots/data/csv.hpp"
#include "mebots/text_file.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace mebots::check {
namespace {

/// Returns the variable of this name if its values are numbers or Booleans; otherwise null.
const Fmi3Declared* find_number(const Fmi3Description& description, const std::string& name) {
  const auto found = std::ranges::find(description.variables(), name, &Fmi3Declared::name);
  if (found == description.variables().end()) return nullptr;
  const bool is_number = found->type != "String" && found->type != "Binary" && found->type != "Clock";
  return is_number ? &*found : nullptr;
}

}  // namespace

std::string fmi3_trace_obstacle(const Fmi3Target& target) {
  const auto files = find_traces(target.folder);
  if (!files) return "the FMU has none in documentation/reference or extra/org.fmi-standard.fmi-ls-ref";
  if (files->inputs.empty()) return {};
  const auto content = text_of(files->inputs);
  const auto name = files->inputs.filename().string();
  const data::CsvReader reader(content, name);
  for (std::size_t i = 1; i < reader.header().size(); ++i) {
    if (find_number(*target.description, reader.header()[i]) == nullptr)
      return fmt::format("{} has \"{}\", which is no variable with numbers of this FMU", name, reader.header()[i]);
  }
  return {};
}

void replay_trace(const Fmi3Library& library) {
  const auto& target = library.target();
  const auto& description = *target.description;
  const auto files = find_traces(target.folder).value();
  const auto is_number = [&](const std::string& name) { return find_number(description, name) != nullptr; };
  const auto outputs = read_trace(files.outputs, true, is_number);
  const auto inputs = files.inputs.empty() ? Trace{{}, {0}, {{}}} : read_trace(files.inputs, false, is_number);
  Fmi3Instance instance(library, "replay");
  const bool reached = replay(
      library.witness(), files, inputs, outputs,
      {.enter_initialization = [&] { instance.enter_initialization(); },
       .exit_initialization = [&] { instance.exit_initialization(); },
       .set = [&](const std::string& name,
                  std::span<const double> values) { instance.set_numbers(*find_number(description, name), values); },
       .get = [&](const std::string& name) { return instance.numbers(*find_number(description, name)); },
       .step = [&](double time_s, double step_s) { instance.step(time_s, step_s); },
       .ended = [&] { return instance.ended(); },
       .is_real = [&](const std::string& name) { return find_number(description, name)->is_float(); }});
  if (reached) instance.terminate();
}

}  // namespace mebots::check
