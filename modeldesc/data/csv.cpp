// SPDX-License-Identifier: Apache-2.0
#include "mebots/data/csv.hpp"

#include "mebots/assert.hpp"
#include "mebots/error.hpp"
#include "mebots/parsed_number.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_set>

namespace mebots::data {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

bool is_line_end(char c) {
  return c == '\n' || c == '\r';
}

/// Returns the line without the parts in quotation marks.
std::string unquoted_part(std::string_view line) {
  std::string part;
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') {
      quoted = !quoted;
    } else if (!quoted) {
      part += c;
    }
  }
  return part;
}

/// Returns a cell in quotes for an error message. Shortens a long cell.
std::string shown(std::string_view cell) {
  constexpr std::size_t kMost = 60;
  return cell.size() <= kMost ? fmt::format("'{}'", cell) : fmt::format("'{}...'", cell.substr(0, kMost));
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t";
  const auto first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) + 1 - first);
}

CsvTitle csv_title(std::string_view title) {
  const auto bracket = title.rfind(" [");
  if (bracket == std::string_view::npos || !title.ends_with(']')) return {std::string(title), {}};
  auto unit = std::string(title.substr(bracket + 2, title.size() - bracket - 3));
  if (unit == "-") unit.clear();
  return {std::string(trimmed(title.substr(0, bracket))), std::move(unit)};
}

CsvReader::CsvReader(std::string_view text, std::string name) : text_(text), name_(std::move(name)) {
  if (text_.starts_with(kByteOrderMark)) text_.remove_prefix(kByteOrderMark.size());
  line_ = 1;
  refuse_other_formats();
  refuse_other_separators();
  read_header();
}

void CsvReader::fail_line(ErrorCode code, std::string_view what) const {
  throw Error(code, fmt::format("{}:{}: {}", name_, line_, what));
}

void CsvReader::fail(std::size_t column, ErrorCode code, std::string_view what) const {
  MEBOTS_ASSERT(column < header_.size());
  fail_line(code, fmt::format("column {} ({}): {}", column + 1, shown(header_[column]), what));
}

void CsvReader::refuse_other_formats() const {
  if (text_.starts_with("PK\x03\x04")) {
    fail_line(ErrorCode::syntax_error, "this is an archive, such as a workbook (.xlsx), and not CSV; export it as CSV");
  }
  constexpr std::size_t kLooked = 4096;
  const bool wide = text_.starts_with("\xFF\xFE") || text_.starts_with("\xFE\xFF");
  if (wide || text_.substr(0, kLooked).find('\0') != std::string_view::npos) {
    fail_line(ErrorCode::syntax_error, "this is UTF-16 or binary, and not CSV in UTF-8; save the file as CSV in UTF-8");
  }
}

/// Throws Error if semicolons or tabs separate the cells. Spreadsheets with a decimal comma use semicolons.
void CsvReader::refuse_other_separators() const {
  const auto first = unquoted_part(text_.substr(0, text_.find_first_of("\n\r")));
  const auto commas = std::ranges::count(first, ',');
  const auto refuse = [&](char separator, std::string_view plural) {
    const auto found = std::ranges::count(first, separator);
    if (found == 0 || found < commas) return;
    fail_line(ErrorCode::syntax_error,
              fmt::format("the cells are separated by {}; a CSV file must have commas as separators and points in "
                          "decimals (1.5, not 1,5). Export it in this form, for instance with an English locale",
                          plural));
  };
  refuse(';', "semicolons");
  refuse('\t', "tabs");
}

void CsvReader::read_header() {
  do {
    if (!split_line()) fail_line(ErrorCode::syntax_error, "there is no header: the first row names the columns");
  } while (cells_.empty());
  std::unordered_set<std::string> names;
  for (const auto cell : cells_) {
    header_.emplace_back(trimmed(cell));
    const auto& name = header_.back();
    if (name.empty()) {
      fail_line(ErrorCode::syntax_error,
                fmt::format("column {} has no name; give every column a name", header_.size()));
    }
    if (!names.insert(name).second) {
      fail_line(ErrorCode::duplicate_name, fmt::format("two columns are named {}; rename one of them", shown(name)));
    }
  }
}

std::optional<std::size_t> CsvReader::column(std::string_view name) const {
  const auto found = std::ranges::find(header_, name);
  if (found == header_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - header_.begin());
}

bool CsvReader::next() {
  do {
    if (!split_line()) return false;
  } while (cells_.empty());
  check_width();
  return true;
}

void CsvReader::check_width() const {
  if (cells_.size() == header_.size()) return;
  fail_line(ErrorCode::syntax_error,
            fmt::format("this row has {} cells, and the header names {} columns{}", cells_.size(), header_.size(),
                        cells_.size() > header_.size() ? "; decimals are written with a point, such as 1.5" : ""));
}

/// Splits the next line into `cells_`. An empty line gives no cells. Returns false at the end of the text.
bool CsvReader::split_line() {
  cells_.clear();
  unquoted_.clear();
  if (at_ >= text_.size()) return false;
  line_ = next_line_;
  if (!is_line_end(text_[at_])) {
    while (true) {
      if (at_ < text_.size() && text_[at_] == '"') {
        take_quoted();
      } else {
        const auto end = std::min(text_.find_first_of(",\n\r", at_), text_.size());
        cells_.push_back(text_.substr(at_, end - at_));
        at_ = end;
      }
      if (at_ >= text_.size() || text_[at_] != ',') break;
      ++at_;
    }
  }
  if (at_ < text_.size()) {
    at_ += text_[at_] == '\r' && at_ + 1 < text_.size() && text_[at_ + 1] == '\n' ? 2 : 1;
    ++next_line_;
  }
  return true;
}

void CsvReader::take_quoted() {
  const auto first = at_ + 1;
  bool doubled = false;
  for (at_ = text_.find('"', first); at_ != std::string_view::npos; at_ = text_.find('"', at_ + 2)) {
    if (at_ + 1 >= text_.size() || text_[at_ + 1] != '"') break;
    doubled = true;
  }
  if (at_ == std::string_view::npos) {
    fail_line(ErrorCode::syntax_error, "a quotation mark that begins here is not closed");
  }
  auto cell = text_.substr(first, at_ - first);
  next_line_ += static_cast<std::size_t>(std::ranges::count(cell, '\n'));
  if (doubled) {
    auto& text = unquoted_.emplace_back();
    for (std::size_t i = 0; i < cell.size(); ++i) {
      text += cell[i];
      if (cell[i] == '"') ++i;
    }
    cell = text;
  }
  cells_.push_back(cell);
  ++at_;
  if (at_ < text_.size() && text_[at_] != ',' && !is_line_end(text_[at_])) {
    fail_line(ErrorCode::syntax_error,
              fmt::format("text follows the closing quotation mark of cell {}; write a quotation mark in a cell twice",
                          cells_.size()));
  }
}

double CsvReader::number(std::size_t column) const {
  auto text = trimmed(cell(column));
  if (text.empty()) fail(column, ErrorCode::wrong_type, "the cell is empty; a number is needed");
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  const auto value = parsed_number<double>(text);
  if (!value) {
    fail(column, ErrorCode::wrong_type,
         fmt::format(
             "{} is not a number{}", shown(cell(column)),
             text.find(',') == std::string_view::npos ? "" : "; decimals are written with a point, such as 1.5"));
  }
  if (!std::isfinite(*value)) {
    fail(column, ErrorCode::not_finite, fmt::format("{} is not a finite number", shown(cell(column))));
  }
  return *value;
}

}  // namespace mebots::data
