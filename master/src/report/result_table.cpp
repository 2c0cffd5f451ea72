// SPDX-License-Identifier: Apache-2.0
#include "report/result_table.hpp"

#include "base/input_text.hpp"
#include "report/thinner.hpp"
#include "sink/csv_cells.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

namespace mebots::master::report {
namespace {

using Column = ResultTable::Column;

/// "battery.cell.voltage [V]" apart.
Column column_of(const std::string& title) {
  const auto bracket = title.rfind(" [");
  if (bracket == std::string::npos || !title.ends_with(']')) return {title, "-", {}};
  return {title.substr(0, bracket), title.substr(bracket + 2, title.size() - bracket - 3), {}};
}

std::vector<Column> read_header(CsvCells& cells, const std::string& file) {
  std::vector<Column> columns;
  do {
    columns.push_back(column_of(cells.next()));
  } while (!cells.line_ended());
  if (columns.front().name != "time" || columns.front().unit != "s") {
    throw InputError(ErrorCode::syntax_error,
                     fmt::format("{}: this is not a table of results: its first column is not 'time [s]'", file));
  }
  return columns;
}

/// Lines that end, the header left out. Quoted texts may hold line ends: then it counts too many, which thins out more.
std::size_t rows_of(std::string_view text) {
  const auto lines = static_cast<std::size_t>(std::ranges::count(text, '\n'));
  return lines == 0 ? 0 : lines - 1;
}

/// What was written of the last line before its process was killed says nothing.
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
  return numbers <= kMostValues ? 1 : (2 * numbers + kMostValues - 1) / kMostValues;  // of a span two rows stay
}

ResultTable read_results(const std::filesystem::path& file, const std::vector<TimeSpan>& whole) {
  const auto content = input_text(file);
  const auto text = whole_lines(content);
  ResultTable table;
  CsvCells cells(text);
  table.columns = read_header(cells, file.string());
  const auto width = table.columns.size();
  table.span = ResultTable::span_of(rows_of(text), width);
  table.whole = whole;
  Thinner thinner(width, table.span);
  std::vector<bool> is_text(width, false);
  std::vector<double> row(width);
  std::string room;
  for (; !cells.at_end(); ++table.rows) {
    for (std::size_t i = 0; i < width; ++i) {
      const auto value = csv_number<double>(cells.next(room));
      if (cells.line_ended() != (i + 1 == width) || (i == 0 && !value)) {
        throw InputError(ErrorCode::syntax_error,
                         fmt::format("{}: row {} does not have a number for the time and {} cells", file.string(),
                                     table.rows + 1, width));
      }
      if (!value) is_text[i] = true;
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

}  // namespace mebots::master::report
