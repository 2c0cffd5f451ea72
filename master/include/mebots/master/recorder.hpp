// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/master/ensemble.hpp"
#include "mebots/master/observer.hpp"
#include "mebots/master/output_file.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::master {

/// Writes results.csv: a header, then one row per communication point (or recording interval), the first
/// at t = 0 and the last at the end. Numbers in their shortest form that reads back to the same bits,
/// Booleans as 0 and 1, enumerations as their numbers.
class Recorder final : public Observer {
 public:
  /// Chooses the columns. Throws InputError for a pattern that fits nothing.
  Recorder(const ResolvedSystem& system, Ensemble& ensemble, OutputFile& file);

  std::optional<std::string> reached(const Point& point) override;
  void ended(const Point& point) override;
  void save(state::Writer& writer) override;
  void restore(state::Reader& reader) override;

  std::size_t columns() const { return columns_.size(); }
  std::int64_t rows() const { return rows_; }

 private:
  struct Column {
    SignalId id;
    const double* real = nullptr;  // one of the two, once the run has begun
    const std::int32_t* integer = nullptr;
  };

  void begin();
  void write_row(const Point& point);

  const Ensemble* ensemble_;
  OutputFile* file_;
  std::int64_t every_steps_;
  std::string header_;
  std::vector<Column> columns_;
  bool begun_ = false;
  std::int64_t rows_ = 0;
  std::int64_t last_step_ = -1;
};

/// The variables that a system records, in the order of instances and descriptions. Throws InputError.
std::vector<ResolvedVariable> recorded_variables(const ResolvedSystem& system);

/// "name [unit]", quoted as CSV asks when it holds a comma or a quotation mark.
std::string csv_header(std::string_view name, std::string_view unit);

/// True when `text` fits a pattern in which `*` stands for any characters and `?` for one.
bool fits(std::string_view text, std::string_view pattern);

}  // namespace mebots::master
