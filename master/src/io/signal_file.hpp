// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/data/csv.hpp"
#include "mebots/modeldesc/model_description.hpp"
#include "model/signal.hpp"

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::master {

/// A column with values of a variable over time. The value of a Real is factor * cell + offset.
struct WantedSignal {
  std::size_t column = 0;
  const modeldesc::ModelDescription* model = nullptr;
  const modeldesc::Variable* variable = nullptr;
  double factor = 1;
  double offset = 0;
};

/// A CSV file with a column of times and columns of values. A title may end with a unit, such as "speed [km/h]".
/// Continuous Reals are interpolated between rows. Other values are constant until the next row.
class SignalFile {
 public:
  /// Reads the header of the file. Errors contain `name`. `time_column` is the title of the column of times. If it is
  /// empty, uses the column `time` or `t`, in upper or lower case. Times are in seconds unless this title contains
  /// another unit. Throws InputError if the header is invalid.
  SignalFile(const std::filesystem::path& file, std::string name, const std::string& time_column);
  SignalFile(const SignalFile&) = delete;
  SignalFile& operator=(const SignalFile&) = delete;

  const std::string& name() const { return reader_.name(); }
  const std::vector<data::CsvTitle>& titles() const { return titles_; }
  std::size_t time_column() const { return time_column_; }
  /// Returns the index of the column with this title, with or without the unit.
  std::optional<std::size_t> find(std::string_view title) const;

  /// Reads all rows and returns a signal for each wanted column. Must be called only once. Throws InputError with line,
  /// column and value if a cell is not a valid value of its variable, if a time is invalid or less than the previous
  /// time, or if three rows have the same time.
  std::vector<std::shared_ptr<const Signal>> read(std::span<const WantedSignal> wanted);

 private:
  std::size_t find_time(const std::string& wanted) const;
  void find_time_unit();
  void read_time(std::vector<double>& times_s);

  std::string text_;
  data::CsvReader reader_;
  std::vector<data::CsvTitle> titles_;
  std::size_t time_column_ = 0;
  double second_ = 1;  // seconds per unit of the time column
};

}  // namespace mebots::master
