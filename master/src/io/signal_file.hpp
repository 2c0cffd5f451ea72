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

/// A column that contains the values of a variable over time. The value of a Real variable is factor * cell + offset.
struct WantedSignal {
  std::size_t column = 0;
  const modeldesc::ModelDescription* model = nullptr;
  const modeldesc::Variable* variable = nullptr;
  double factor = 1;
  double offset = 0;
};

/// A CSV file of signals. One column contains times; the other columns contain values. A title may end with a unit, as
/// in "speed [km/h]". Values of continuous Reals are interpolated between rows. All other values are constant until the
/// next row.
class SignalFile {
 public:
  /// Reads the header of the file. `name` is the name of the file in errors. If `time_column` is empty, the time column
  /// is the one named time or t, in upper or lower case. Times are in seconds, unless the title of the column contains
  /// another unit. Throws InputError if the header is invalid.
  SignalFile(const std::filesystem::path& file, std::string name, const std::string& time_column);
  SignalFile(const SignalFile&) = delete;
  SignalFile& operator=(const SignalFile&) = delete;

  const std::string& name() const { return reader_.name(); }
  const std::vector<data::CsvTitle>& titles() const { return titles_; }
  std::size_t time_column() const { return time_column_; }
  /// Returns the index of the column with this name. The name may contain the unit.
  std::optional<std::size_t> find(std::string_view title) const;

  /// Reads all rows, and returns one signal for each wanted column. Must be called only once. Throws InputError with
  /// line, column and value if a variable cannot have the value of a cell. Throws the same error if a time is invalid
  /// or less than the previous time, or if three rows have the same time.
  std::vector<std::shared_ptr<const Signal>> read(std::span<const WantedSignal> wanted);

 private:
  std::size_t find_time(const std::string& wanted) const;
  void find_time_unit();
  void read_time(std::vector<double>& times_s);

  std::string text_;
  data::CsvReader reader_;
  std::vector<data::CsvTitle> titles_;
  std::size_t time_column_ = 0;
  double second_ = 1;  // number of seconds in the column's unit of time
};

}  // namespace mebots::master
