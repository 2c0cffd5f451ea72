// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/error_code.hpp"

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::data {

/// Reads a table in CSV (RFC 4180) row by row. Commas separate the cells, the decimal separator is a point, and one
/// header row contains the names of the columns. Accepts a byte order mark, CR LF and CR as line ends, quoted cells,
/// and blanks around names and numbers. Skips empty lines. Throws Error with file and line, and with the column if the
/// error is in a cell.
class CsvReader {
 public:
  /// Reads the header. `text` must outlive the reader; `name` is the file's name in errors. Throws Error if the text is
  /// not CSV, such as UTF-16 text or a workbook, or if cells are not separated by commas.
  CsvReader(std::string_view text, std::string name);

  const std::string& name() const { return name_; }
  const std::vector<std::string>& header() const { return header_; }
  /// Returns the index of the column with this name; empty if no column has this name.
  std::optional<std::size_t> column(std::string_view name) const;

  /// Reads the next row. Returns false at the end of the text. Throws Error if the number of cells differs from the
  /// number of columns.
  bool next();
  /// Returns the number of the line on which the row starts, from 1.
  std::size_t line() const { return line_; }
  /// Returns a cell of the current row without its quotation marks. The result is valid until the next call of next().
  std::string_view cell(std::size_t column) const { return cells_[column]; }
  /// Throws Error if the cell is not a finite number.
  double number(std::size_t column) const;

  /// Throws Error with the file, line and column of the cell, followed by `what`.
  [[noreturn]] void fail(std::size_t column, ErrorCode code, std::string_view what) const;

 private:
  [[noreturn]] void fail_line(ErrorCode code, std::string_view what) const;
  void refuse_other_formats() const;
  void refuse_other_separators() const;
  void read_header();
  bool split_line();
  void take_quoted();
  void check_width() const;

  std::string_view text_;
  std::string name_;
  std::vector<std::string> header_;
  std::vector<std::string_view> cells_;  // the cells of the row; each is a view of the text or of `unquoted_`
  std::deque<std::string> unquoted_;     // stores the cells with doubled quotation marks
  std::size_t at_ = 0;
  std::size_t next_line_ = 1;
  std::size_t line_ = 0;
};

/// Removes blanks and tabs from both ends.
std::string_view trimmed(std::string_view text);

/// Contains the parts of a column title such as "speed [km/h]". The unit is empty if the title has none or "-".
struct CsvTitle {
  std::string name;
  std::string unit;
};

CsvTitle csv_title(std::string_view title);

}  // namespace mebots::data
