// SPDX-License-Identifier: Apache-2.0
#include "mebots/master/recorder.hpp"

#include "mebots/master/nearest_names.hpp"
#include "mebots/master/time.hpp"

#include <fmt/format.h>

#include <charconv>

namespace mebots::master {
namespace {

using modeldesc::Causality;
using modeldesc::Type;

/// The longest double in shortest form has 24 characters.
constexpr std::size_t kLongestNumber = 32;

template <typename T>
void append_number(std::string& row, T value) {
  const auto size = row.size();
  row.resize(size + kLongestNumber);
  const auto result = std::to_chars(row.data() + size, row.data() + row.size(), value);
  row.resize(static_cast<std::size_t>(result.ptr - row.data()));
}

}  // namespace

bool fits(std::string_view text, std::string_view pattern) {
  // Greedy with one way back: the last star takes one more character whenever the rest does not fit.
  std::size_t t = 0;
  std::size_t p = 0;
  std::size_t star = std::string_view::npos;
  std::size_t after_star = 0;
  while (t < text.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      after_star = t;
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == text[t])) {
      ++p;
      ++t;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      t = ++after_star;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

std::string csv_header(std::string_view name, std::string_view unit) {
  auto text = fmt::format("{} [{}]", name, unit.empty() ? "-" : unit);
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

std::vector<ResolvedVariable> recorded_variables(const ResolvedSystem& system) {
  const auto& record = system.description->record;
  std::vector<ResolvedVariable> chosen;
  std::vector<std::string> names;
  std::vector<bool> used(record.patterns ? record.patterns->size() : 0, false);
  for (std::size_t i = 0; i < system.instances.size(); ++i) {
    const auto& model = system.instances[i].fmu->description();
    for (const auto& variable : model.variables) {
      if (variable.type == Type::string || is_osmp_part(model, variable)) continue;
      const ResolvedVariable candidate{i, &variable};
      const auto name = system.text(candidate);
      bool wanted = !record.patterns && variable.causality == Causality::output;
      for (std::size_t p = 0; p < used.size(); ++p) {
        if (!fits(name, (*record.patterns)[p].pattern)) continue;
        used[p] = true;
        // A pattern that names one variable outright may name any; one with a star means outputs.
        wanted = wanted || variable.causality == Causality::output || name == (*record.patterns)[p].pattern;
      }
      if (wanted) chosen.push_back(candidate);
      if (variable.causality == Causality::output) names.push_back(name);
    }
  }
  for (std::size_t p = 0; p < used.size(); ++p) {
    if (used[p]) continue;
    const auto& [pattern, place] = (*record.patterns)[p];
    throw InputError(
        fmt::format("{}: nothing that can be recorded fits '{}'. {}", place, pattern, suggest(pattern, names)));
  }
  return chosen;
}

Recorder::Recorder(const ResolvedSystem& system, Ensemble& ensemble, OutputFile& file)
    : ensemble_(&ensemble), file_(&file), every_steps_(1), header_("time [s]") {
  const auto& description = *system.description;
  if (description.record.interval_ns > 0) every_steps_ = description.record.interval_ns / description.step_ns;
  for (const auto& variable : recorded_variables(system)) {
    columns_.push_back({ensemble.watch(variable)});
    header_ += "," + csv_header(system.text(variable), variable.variable->unit);
  }
  header_ += '\n';
}

void Recorder::begin() {
  begun_ = true;
  for (auto& column : columns_) {
    if (column.id.kind == ValueKind::real) {
      column.real = &ensemble_->real(column.id);
    } else {
      column.integer = &ensemble_->integer(column.id);
    }
  }
  if (file_->size() == 0) file_->append(header_);
}

std::optional<std::string> Recorder::reached(const Point& point) {
  if (!begun_) begin();
  if (point.step % every_steps_ == 0) write_row(point);
  return std::nullopt;
}

void Recorder::ended(const Point& point) {
  if (last_step_ != point.step) write_row(point);
}

void Recorder::write_row(const Point& point) {
  auto& row = file_->buffer();
  append_number(row, to_seconds(point.time_ns));
  for (const auto& column : columns_) {
    row += ',';
    if (column.real != nullptr) {
      append_number(row, *column.real);
    } else if (column.id.kind == ValueKind::boolean) {
      row += *column.integer == 0 ? '0' : '1';
    } else {
      append_number(row, *column.integer);
    }
  }
  row += '\n';
  last_step_ = point.step;
  ++rows_;
  file_->written();
}

void Recorder::save(state::Writer& writer) {
  file_->flush();
  writer.put(file_->size());
  writer.put(rows_);
  writer.put(last_step_);
}

void Recorder::restore(state::Reader& reader) {
  file_->truncate(reader.get<std::uint64_t>());
  reader.get(rows_);
  reader.get(last_step_);
  if (!begun_) begin();
}

}  // namespace mebots::master
