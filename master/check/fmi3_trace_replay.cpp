// SPDX-License-Identifier: Apache-2.0
#include "fmi3_instance.hpp"
#include "trace_file.hpp"

#include "mebots/data/csv.hpp"
#include "mebots/error.hpp"
#include "mebots/text_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

namespace mebots::check {
namespace {

/// Returns the variable of this name if its values are numbers or Booleans; otherwise null.
const Fmi3Declared* find_number(const Fmi3Description& description, const std::string& name) {
  const auto found = std::ranges::find(description.variables(), name, &Fmi3Declared::name);
  if (found == description.variables().end()) return nullptr;
  const bool is_number = found->type != "String" && found->type != "Binary" && found->type != "Clock";
  return is_number ? &*found : nullptr;
}

/// Returns the names of the columns after the first, which is time.
std::vector<std::string> columns_of(const std::filesystem::path& file) {
  const auto content = text_of(file);
  const data::CsvReader reader(content, file.filename().string());
  return {reader.header().begin() + 1, reader.header().end()};
}

}  // namespace

Fmi3TraceScope fmi3_trace_scope(const Fmi3Target& target) {
  const auto files = find_traces(target.folder);
  if (!files) return {.obstacle = "the FMU has none in documentation/reference or extra/org.fmi-standard.fmi-ls-ref"};
  const auto is_number = [&](const std::string& name) { return find_number(*target.description, name) != nullptr; };
  try {
    const auto inputs = files->inputs.empty() ? std::vector<std::string>{} : columns_of(files->inputs);
    const auto unknown = std::ranges::find_if_not(inputs, is_number);
    if (unknown != inputs.end())
      return {.obstacle = fmt::format("{} has \"{}\", which is no variable with numbers of this FMU",
                                      files->inputs.filename().string(), *unknown)};
    const auto outputs = columns_of(files->outputs);
    const auto compared = static_cast<std::size_t>(std::ranges::count_if(outputs, is_number));
    if (compared == 0) {
      static_cast<void>(read_trace(files->outputs, true, is_number));  // throws if the file is not CSV
      return {.obstacle = fmt::format("{} has no column with numbers of this FMU", files->outputs.filename().string())};
    }
    return {.columns = outputs.size(), .compared = compared};
  } catch (const Error&) {
    return {};
  }
}

void replay_trace(const Fmi3Library& library) {
  const auto& target = library.target();
  const auto& description = *target.description;
  const auto files = find_traces(target.folder).value();
  const auto is_number = [&](const std::string& name) { return find_number(description, name) != nullptr; };
  const auto outputs = read_trace(files.outputs, true, is_number);
  const auto inputs = read_inputs(files, false, is_number);
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
