// SPDX-License-Identifier: Apache-2.0
#include "report/result_table.hpp"

#include "base/input_text.hpp"
#include "mebots/assert.hpp"
#include "mebots/data/csv.hpp"
#include "mebots/parsed_number.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

namespace mebots::master::report {
namespace {

using Column = ResultTable::Column;

std::vector<Column> read_header(const data::CsvReader& reader) {
  std::vector<Column> columns;
  for (const auto& title : reader.header()) {
    auto [name, unit] = data::csv_title(title);
    columns.push_back({std::move(name), unit.empty() ? "-" : std::move(unit), {}});
  }
  if (columns.front().name != "time" || columns.front().unit != "s") {
    throw InputError(
        ErrorCode::syntax_error,
        fmt::format("{}: this is not a table of results: its first column is not 'time [s]'", reader.name()));
  }
  return columns;
}

/// Returns the number of complete lines after the header. Also counts line breaks in quoted texts. If the number is too
/// large, the table is reduced more than necessary.
std::size_t rows_of(std::string_view text) {
  const auto lines = static_cast<std::size_t>(std::ranges::count(text, '\n'));
  return lines == 0 ? 0 : lines - 1;
}

/// Removes the incomplete last line of a killed run.
std::string_view whole_lines(std::string_view text) {
  const auto end = text.rfind('\n');
  return end == std::string_view::npos ? std::string_view() : text.substr(0, end + 1);
}

void drop_texts(ResultTable& table, const std::vector<bool>& is_text) {
  std::vector<Column> kept;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    if (is_text[i]) {
      table.texts.push_back(table.columns[i].name);
    } else {
      kept.push_back(std::move(table.columns[i]));
    }
  }
  table.columns = std::move(kept);
}

}  // namespace

std::size_t ResultTable::span_of(std::size_t rows, std::size_t columns) {
  const auto numbers = rows * columns;
  return numbers <= kMostValues ? 1 : (2 * numbers + kMostValues - 1) / kMostValues;  // two rows remain per span
}

namespace {

ResultTable read_rows(data::CsvReader& reader, std::size_t rows, const std::vector<TimeSpan>& whole,
                      const std::set<std::string>& texts) {
  ResultTable table;
  table.columns = read_header(reader);
  const auto width = table.columns.size();
  table.span = ResultTable::span_of(rows, width);
  table.whole = whole;
  Thinner thinner(width, table.span);
  std::vector<bool> is_text(width, false);
  for (std::size_t i = 1; i < width; ++i) is_text[i] = texts.contains(table.columns[i].name);
  std::vector<double> row(width);
  for (; reader.next(); ++table.rows) {
    row[0] = reader.number(0);
    for (std::size_t i = 1; i < width; ++i) {
      if (is_text[i]) continue;  // columns with texts are omitted
      const auto value = parsed_number<double>(reader.cell(i));
      is_text[i] = !value;
      row[i] = value.value_or(0);
    }
    if (std::ranges::any_of(whole, [&](const TimeSpan& span) { return span.holds(row[0]); })) {
      thinner.keep(row);
    } else {
      thinner.add(row);
    }
  }
  thinner.finish();
  for (std::size_t i = 0; i < width; ++i) table.columns[i].values = std::move(thinner.values()[i]);
  drop_texts(table, is_text);
  return table;
}

}  // namespace

ResultTable read_results(const std::filesystem::path& file, const std::vector<TimeSpan>& whole,
                         const std::set<std::string>& texts) {
  const auto content = input_text(file);
  const auto text = whole_lines(content);
  return refused_as_input([&] {
    data::CsvReader reader(text, file.string());
    return read_rows(reader, rows_of(text), whole, texts);
  });
}

Thinner::Thinner(std::size_t columns, std::size_t span)
    : span_(span), least_(columns), greatest_(columns), values_(columns) {
  MEBOTS_ASSERT(span > 0);
}

void Thinner::add(std::span<const double> row) {
  MEBOTS_ASSERT(row.size() == values_.size());
  if (span_ == 1) return keep(row);
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (rows_ == 0 || row[i] < least_[i].value) least_[i] = {row[i], rows_};
    if (rows_ == 0 || row[i] > greatest_[i].value) greatest_[i] = {row[i], rows_};
  }
  if (++rows_ == span_) finish();
}

void Thinner::keep(std::span<const double> row) {
  MEBOTS_ASSERT(row.size() == values_.size());
  finish();
  for (std::size_t i = 0; i < row.size(); ++i) values_[i].push_back(row[i]);
}

void Thinner::finish() {
  if (rows_ == 0) return;
  for (std::size_t i = 0; i < values_.size(); ++i) {
    const auto& [first, last] =
        std::minmax(least_[i], greatest_[i], [](const Extreme& a, const Extreme& b) { return a.row < b.row; });
    values_[i].push_back(first.value);
    if (rows_ > 1) values_[i].push_back(last.value);
  }
  rows_ = 0;
}

}  // namespace mebots::master::report
