// SPDX-License-Identifier: Apache-2.0
#include "fmi3_variables.hpp"
#include "generate.hpp"

#include <fmt/format.h>

#include <map>
#include <string>
#include <vector>

namespace mebots::modeldesc {
namespace {

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '<')
      result += "&lt;";
    else if (c == '>')
      result += "&gt;";
    else if (c == '&')
      result += "&amp;";
    else if (c == '"')
      result += "&quot;";
    else
      result += c;
  }
  return result;
}

std::string start_text(const ModelDescription& description, const Variable& variable) {
  if (const auto* real = std::get_if<double>(&variable.start)) return fmt::format("{:g}", *real);
  if (const auto* boolean = std::get_if<bool>(&variable.start)) return *boolean ? "true" : "false";
  if (const auto* text = std::get_if<std::string>(&variable.start)) return escaped("\"" + *text + "\"");
  if (const auto* integer = std::get_if<std::int64_t>(&variable.start)) {
    if (const TypeDefinition* type = description.type_definition(variable.declared_type))
      for (const EnumerationItem& item : type->items)
        if (item.value == *integer) return escaped(item.name);
    return fmt::format("{}", *integer);
  }
  return "";
}

std::string range_text(const Variable& variable) {
  if (variable.min && variable.max) return fmt::format("{:g} to {:g}", *variable.min, *variable.max);
  if (variable.min) return fmt::format("&ge; {:g}", *variable.min);
  if (variable.max) return fmt::format("&le; {:g}", *variable.max);
  return "";
}

struct Row {
  std::string name;
  std::string unit;
  std::string type;
  std::string start;
  std::string range;
  std::string text;
};
using Rows = std::map<Causality, std::vector<Row>>;

Rows rows_of(const ModelDescription& description) {
  Rows rows;
  for (const Variable& variable : description.variables) {
    const std::string type =
        variable.declared_type.empty() ? std::string(to_string(variable.type)) : variable.declared_type;
    rows[variable.causality].push_back(
        {variable.name, variable.unit, type, start_text(description, variable), range_text(variable), variable.text});
  }
  return rows;
}

/// Returns the rows of the page's table of variables for FMI 3.0. The start values of an array's elements share one
/// cell.
Rows fmi3_rows(const Description& description, const ModelDescription& common) {
  Rows rows;
  for (const Fmi3Variable& variable : fmi3_variables(description)) {
    const Field& field = *variable.field;
    std::string type = field.enumeration.empty() ? fmi3_type(variable) : field.enumeration;
    if (variable.is_array) type += fmt::format("[{}]", variable.elements);
    std::string start;
    for (std::size_t i = 0; i < variable.elements && field.type != FieldType::binary; ++i)
      start += (i == 0 ? "" : ", ") + start_text(common, common.variables[variable.value_reference + i]);
    if (field.starts.empty()) start.clear();
    rows[field.causality].push_back({variable.name, field.unit, type, start,
                                     range_text(common.variables[variable.value_reference]), variable.text});
  }
  return rows;
}

void write_table(std::string& out, const Rows& all, Causality causality, const char* heading) {
  const auto found = all.find(causality);
  if (found == all.end()) return;
  std::string rows;
  for (const Row& row : found->second)
    rows +=
        fmt::format("<tr><td><code>{}</code></td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
                    escaped(row.name), escaped(row.unit), escaped(row.type), row.start, row.range, escaped(row.text));
  out += fmt::format(
      "<h2>{}</h2>\n<table>\n<tr><th>Name</th><th>Unit</th><th>Type</th><th>Start</th><th>Range</th><th>Meaning</th></"
      "tr>\n"
      "{}</table>\n",
      heading, rows);
}

std::string write_page(const ModelDescription& description, std::string_view version, const Rows& rows) {
  std::string out = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{0}</title>\n<style>\n"
      "body {{ font-family: sans-serif; max-width: 70em; margin: 2em auto; padding: 0 1em; color: #222; }}\n"
      "table {{ border-collapse: collapse; width: 100%; font-size: 0.9em; }}\n"
      "th, td {{ border-bottom: 1px solid #ccc; padding: 0.3em 0.6em; text-align: left; vertical-align: top; }}\n"
      "th {{ background: #f2f2f2; }}\n</style>\n</head>\n<body>\n<h1>{0}</h1>\n<p>{1}.</p>\n",
      escaped(description.model_name), escaped(description.text));
  out += fmt::format(
      "<p>A co-simulation FMU for FMI {}. Default step {:g} s, default stop time {:g} s. Any step size is "
      "possible. The state can be saved, restored and serialised. A process may contain many instances.</p>\n",
      version, description.default_experiment.step_size_s.value_or(0),
      description.default_experiment.stop_time_s.value_or(0));
  write_table(out, rows, Causality::parameter, "Parameters");
  write_table(out, rows, Causality::input, "Inputs");
  write_table(out, rows, Causality::output, "Outputs");
  for (const TypeDefinition& type : description.types) {
    if (type.type != Type::enumeration) continue;
    out += fmt::format("<h2>Type {}</h2>\n<table>\n<tr><th>Value</th><th>Name</th></tr>\n", escaped(type.name));
    for (const EnumerationItem& item : type.items)
      out += fmt::format("<tr><td>{}</td><td>{}</td></tr>\n", item.value, escaped(item.name));
    out += "</table>\n";
  }
  out += "<h2>Log categories</h2>\n<table>\n<tr><th>Name</th><th>Meaning</th></tr>\n";
  for (const LogCategory& category : description.log_categories)
    out +=
        fmt::format("<tr><td><code>{}</code></td><td>{}</td></tr>\n", escaped(category.name), escaped(category.text));
  out += fmt::format(
      "</table>\n<p>Made with {}. Licence: {}, see <a "
      "href=\"licenses/license.txt\">licenses/license.txt</a>.</p>\n</body>\n</html>\n",
      escaped(description.generation_tool), escaped(description.license));
  return out;
}

}  // namespace

std::string write_html(const ModelDescription& description) {
  return write_page(description, "2.0", rows_of(description));
}

std::string write_fmi3_html(const Description& description, const ModelDescription& common) {
  return write_page(common, "3.0", fmi3_rows(description, common));
}

}  // namespace mebots::modeldesc
