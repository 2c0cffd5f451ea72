// SPDX-License-Identifier: Apache-2.0
#include "behaviour_check.hpp"

#include "mebots/data/csv.hpp"
#include "mebots/text_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <pugixml.hpp>

namespace mebots::check {
namespace {

namespace fs = std::filesystem;
using modeldesc::Type;

constexpr double kRelative = 1e-6;
constexpr double kAbsolute = 1e-9;

struct Trace {
  std::vector<const Variable*> variables;  // of the compared columns
  std::vector<double> times;
  std::vector<std::vector<double>> rows;
};

/// Returns the number in a cell. XML Schema's words for Booleans count as 0 and 1.
double value_of(const data::CsvReader& reader, std::size_t column) {
  const auto text = data::trimmed(reader.cell(column));
  if (text == "true" || text == "false") return text == "true" ? 1 : 0;
  return reader.number(column);
}

Trace read_trace(const fs::path& file, const ModelDescription& model, bool of_many_versions) {
  const auto content = text_of(file);
  data::CsvReader reader(content, file.filename().string());
  const auto& header = reader.header();
  Trace trace;
  std::vector<std::size_t> kept;
  for (std::size_t i = 1; i < header.size(); ++i) {
    const auto* variable = model.find(header[i]);
    const bool number = variable != nullptr && variable->type != Type::string;
    if (!number && !of_many_versions) reader.fail(i, ErrorCode::syntax_error, "this is not a number of this FMU");
    if (!number) continue;
    trace.variables.push_back(variable);
    kept.push_back(i);
  }
  while (reader.next()) {
    trace.times.push_back(value_of(reader, 0));
    auto& row = trace.rows.emplace_back();
    for (const auto column : kept) row.push_back(value_of(reader, column));
  }
  if (trace.rows.empty()) throw Error(ErrorCode::syntax_error, fmt::format("{}: there are no rows", reader.name()));
  return trace;
}

void apply(Instance& instance, const Trace& trace, double time_s) {
  std::size_t row = 0;
  while (row + 1 < trace.times.size() && trace.times[row + 1] <= time_s + kAbsolute) ++row;
  for (std::size_t i = 0; i < trace.variables.size(); ++i) {
    const auto reference = trace.variables[i]->value_reference;
    const double value = trace.rows[row][i];
    const auto whole = static_cast<fmi2Integer>(value);
    const auto& f = instance.functions();
    const auto call = fmt::format("setting {} = {}", trace.variables[i]->name, value);
    instance.doing(call);
    switch (trace.variables[i]->type) {
      case Type::real:
        instance.require(call, f.set_real(instance.component(), &reference, 1, &value));
        break;
      case Type::boolean:
        instance.require(call, f.set_boolean(instance.component(), &reference, 1, &whole));
        break;
      default:
        instance.require(call, f.set_integer(instance.component(), &reference, 1, &whole));
    }
  }
}

double read(Instance& instance, const Variable& variable) {
  const auto& f = instance.functions();
  const auto call = fmt::format("getting {}", variable.name);
  instance.doing(call);
  if (variable.type == Type::real) {
    fmi2Real value = 0;
    instance.require(call, f.get_real(instance.component(), &variable.value_reference, 1, &value));
    return value;
  }
  fmi2Integer value = 0;
  const auto function = variable.type == Type::boolean ? f.get_boolean : f.get_integer;
  instance.require(call, function(instance.component(), &variable.value_reference, 1, &value));
  return value;
}

}  // namespace

std::optional<TraceFiles> find_traces(const fs::path& folder) {
  constexpr std::string_view kEnd = "_out.csv";
  const auto with_inputs = [&](const fs::path& outputs, bool of_many_versions) {
    const auto name = outputs.filename().string();
    TraceFiles files{outputs.parent_path() / (name.substr(0, name.size() - kEnd.size()) + "_in.csv"), outputs,
                     of_many_versions};
    if (!name.ends_with(kEnd) || !fs::exists(files.inputs)) files.inputs.clear();
    return files;
  };
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder / "documentation" / "reference", ignored)) {
    if (entry.path().filename().string().ends_with(kEnd)) return with_inputs(entry.path(), false);
  }
  const auto layered = folder / "extra" / "org.fmi-standard.fmi-ls-ref";
  pugi::xml_document manifest;
  if (!manifest.load_file((layered / "fmi-ls-manifest.xml").c_str())) return std::nullopt;
  for (const auto related : manifest.child("fmiReferences").children("Related")) {
    const fs::path source = related.attribute("source").value();
    const bool result = related.attribute("role").value() == std::string_view("result") &&
                        related.attribute("type").value() == std::string_view("text/csv");
    if (result && source == source.filename() && fs::exists(layered / source))
      return with_inputs(layered / source, true);
  }
  return std::nullopt;
}

void replay(const Library& library, const TraceFiles& files) {
  const auto& model = *library.target().model;
  const auto wanted = read_trace(files.outputs, model, files.of_many_versions);
  const auto inputs =
      files.inputs.empty() ? Trace{{}, {0}, {{}}} : read_trace(files.inputs, model, files.of_many_versions);
  Instance instance(library, "replay");
  instance.setup();
  instance.enter();
  apply(instance, inputs, wanted.times.front());
  instance.exit();
  for (std::size_t row = 0; row < wanted.rows.size(); ++row) {
    for (std::size_t i = 0; i < wanted.variables.size(); ++i) {
      const auto& variable = *wanted.variables[i];
      const double value = read(instance, variable);
      const double trace = wanted.rows[row][i];
      const double allowed = variable.type == Type::real ? std::max(kAbsolute, kRelative * std::abs(trace)) : 0;
      if (std::abs(value - trace) <= allowed) continue;
      library.witness().error(
          fmt::format("{}: first divergence at {} s: {} is {}, the trace has {}", files.outputs.filename().string(),
                      wanted.times[row], variable.name, value, trace),
          "the model changed, or its inputs do not determine its outputs: correct it, or record the traces again");
      return;
    }
    if (row + 1 == wanted.rows.size()) break;
    if (instance.ended()) {
      library.witness().error(fmt::format("{}: the FMU ended the run at {} s, before the end of the trace",
                                          files.outputs.filename().string(), wanted.times[row]),
                              "correct the model, or record the traces again");
      return;
    }
    apply(instance, inputs, wanted.times[row]);
    instance.step(wanted.times[row], wanted.times[row + 1] - wanted.times[row]);
  }
  instance.terminate();
}

}  // namespace mebots::check
