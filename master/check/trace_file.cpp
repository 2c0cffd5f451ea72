// SPDX-License-Identifier: Apache-2.0
#include "trace_file.hpp"

#include "mebots/data/csv.hpp"
#include "mebots/error.hpp"
#include "mebots/modeldesc/xml.hpp"
#include "mebots/parsed_number.hpp"
#include "mebots/text_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <pugixml.hpp>

namespace mebots::check {
namespace {

namespace fs = std::filesystem;

constexpr double kRelative = 1e-6;
constexpr double kAbsolute = 1e-9;

/// Returns the numbers in a cell. The Booleans true and false become 1 and 0.
Trace::Cell cell_numbers(const data::CsvReader& reader, std::size_t column) {
  Trace::Cell numbers;
  for (const auto& word : modeldesc::words_of(reader.cell(column))) {
    const bool is_boolean = word == "true" || word == "false";
    const auto number = is_boolean ? std::optional(word == "true" ? 1.0 : 0.0) : parsed_number<double>(word);
    if (!number || !std::isfinite(*number)) reader.fail(column, ErrorCode::syntax_error, "this is not a number");
    numbers.push_back(*number);
  }
  if (numbers.empty()) reader.fail(column, ErrorCode::syntax_error, "this is not a number");
  return numbers;
}

/// Returns the column names without the first column, which is the time.
std::vector<std::string> columns_of(const fs::path& file) {
  const auto content = text_of(file);
  const data::CsvReader reader(content, file.filename().string());
  return {reader.header().begin() + 1, reader.header().end()};
}

void apply(const TracedInstance& instance, const Trace& trace, double time_s) {
  std::size_t row = 0;
  while (row + 1 < trace.times.size() && trace.times[row + 1] <= time_s + kAbsolute) ++row;
  for (std::size_t i = 0; i < trace.names.size(); ++i) instance.set(trace.names[i], trace.rows[row][i]);
}

bool agrees(double value, double trace, bool is_real) {
  return std::abs(value - trace) <= (is_real ? std::max(kAbsolute, kRelative * std::abs(trace)) : 0);
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

std::string TraceScope::check_name() const {
  constexpr auto kName = "reference traces are reproduced";
  return compared == columns ? kName : fmt::format("{}, in {} of {} columns", kName, compared, columns);
}

TraceScope trace_scope(const std::optional<TraceFiles>& files,
                       const std::function<bool(const std::string& name)>& is_number) {
  if (!files) return {.obstacle = "the FMU has none in documentation/reference or extra/org.fmi-standard.fmi-ls-ref"};
  try {
    const auto inputs = files->inputs.empty() ? std::vector<std::string>{} : columns_of(files->inputs);
    const auto unknown = std::ranges::find_if_not(inputs, is_number);
    if (unknown != inputs.end())
      return {.obstacle = fmt::format("{} has \"{}\", which is not a numeric variable of this FMU",
                                      files->inputs.filename().string(), *unknown)};
    const auto outputs = columns_of(files->outputs);
    const auto compared = static_cast<std::size_t>(std::ranges::count_if(outputs, is_number));
    if (compared == 0)
      return {.obstacle = fmt::format("{} has no column with numbers of this FMU", files->outputs.filename().string())};
    return {.columns = outputs.size(), .compared = compared};
  } catch (const Error&) {
    return {};
  }
}

Trace read_trace(const fs::path& file, bool ignores_others,
                 const std::function<bool(const std::string& name)>& is_number) {
  const auto content = text_of(file);
  data::CsvReader reader(content, file.filename().string());
  const auto& header = reader.header();
  Trace trace;
  std::vector<std::size_t> kept;
  for (std::size_t i = 1; i < header.size(); ++i) {
    const std::string& name = header[i];
    const bool number = is_number(name);
    if (!number && !ignores_others)
      reader.fail(i, ErrorCode::syntax_error, "this is not a numeric variable of this FMU");
    if (!number) continue;
    trace.names.push_back(name);
    kept.push_back(i);
  }
  while (reader.next()) {
    trace.times.push_back(reader.number(0));
    auto& row = trace.rows.emplace_back();
    for (const auto column : kept) row.push_back(cell_numbers(reader, column));
  }
  if (trace.rows.empty()) throw Error(ErrorCode::syntax_error, fmt::format("{}: there are no rows", reader.name()));
  return trace;
}

Trace read_inputs(const TraceFiles& files, const std::function<bool(const std::string& name)>& is_number) {
  if (files.inputs.empty()) return {.names = {}, .times = {0}, .rows = {{}}};
  return read_trace(files.inputs, false, is_number);
}

bool replay(Witness& witness, const TraceFiles& files, const Trace& inputs, const Trace& outputs,
            const TracedInstance& instance) {
  const auto name_of_file = files.outputs.filename().string();
  instance.enter_initialization();
  apply(instance, inputs, outputs.times.front());
  instance.exit_initialization();
  for (std::size_t row = 0; row < outputs.rows.size(); ++row) {
    for (std::size_t i = 0; i < outputs.names.size(); ++i) {
      const auto& name = outputs.names[i];
      const auto& wanted = outputs.rows[row][i];
      const auto found = instance.get(name);
      const bool is_real = instance.is_real(name);
      const bool same = std::ranges::equal(found, wanted, [&](double a, double b) { return agrees(a, b, is_real); });
      if (same) continue;
      witness.error(fmt::format("{}: first divergence at {} s: {} is {}, the trace has {}", name_of_file,
                                outputs.times[row], name, fmt::join(found, " "), fmt::join(wanted, " ")),
                    "the model changed, or its inputs do not determine its outputs: correct it, or record the traces "
                    "again");
      return false;
    }
    if (row + 1 == outputs.rows.size()) break;
    if (instance.ended()) {
      witness.error(fmt::format("{}: the FMU ended the run at {} s, before the end of the trace", name_of_file,
                                outputs.times[row]),
                    "correct the model, or record the traces again");
      return false;
    }
    apply(instance, inputs, outputs.times[row]);
    instance.step(outputs.times[row], outputs.times[row + 1] - outputs.times[row]);
  }
  return true;
}

}  // namespace mebots::check
