// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/ensemble.hpp"
#include "record/observer.hpp"
#include "record/sink/block_writer.hpp"
#include "record/sink/row_block.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::master {

/// Records one row at each communication point, or at each recording interval. The first row is at t = 0, the last row
/// at the end of the run. The simulation only copies numbers; another thread writes the files.
class Recorder final : public Observer {
 public:
  /// Selects the columns. Throws InputError if a pattern matches no variable.
  Recorder(const ResolvedSystem& system, Ensemble& ensemble);

  /// Adds a sink that receives the rows. Must be called before the first point.
  void add(std::unique_ptr<RowSink> sink);

  std::optional<std::string> reached(const Point& point) override;
  void ended(const Point& point) override;
  /// Writes all rows so far to the files. Throws Error if they cannot be written, for example because the disk is full.
  void flush() { writer_.drain(block_); }
  void visit(state::Visitor& v) override;
  std::string_view state_name() const override { return "recorder"; }

  const std::vector<RecordColumn>& columns() const { return columns_; }
  std::int64_t rows() const { return rows_; }

 private:
  /// Points to the source of a column's values. Exactly one pointer is not null.
  struct Source {
    const double* real = nullptr;
    const std::int64_t* integer = nullptr;
    bool binary = false;  // true if the text contains bytes, which are written as hexadecimal digits
    const std::string* text = nullptr;
    bool boolean = false;
  };

  void find_sources();
  void write_row(const Point& point);

  const Ensemble* ensemble_;
  TimeGrid grid_;
  std::int64_t every_steps_;
  std::vector<RecordColumn> columns_;
  std::vector<SignalId> signals_;
  bool records_step_ = false;             // true: the length of the step is the first column
  double step_s_ = 0;                     // length of the step that ends at this point; 0 at the start
  std::optional<std::int64_t> point_ns_;  // time of the last point, stored if the step is recorded
  std::vector<Source> sources_;           // set when the run begins
  RowBlock block_;
  std::size_t text_bytes_ = 0;  // number of bytes of texts in `block_`
  std::vector<std::unique_ptr<RowSink>> sinks_;
  BlockWriter writer_;  // declared after the sinks, which must outlive it
  std::int64_t rows_ = 0;
  std::int64_t last_step_ = -1;
};

/// Reads the recorded parameters from the slaves. Must be called after the slaves were initialised.
std::vector<ParameterValue> read_parameters(const ResolvedSystem& system, Ensemble& ensemble);

/// Writes parameters.csv at t = 0. Each row contains the name, unit and value of a parameter. The file is separate,
/// because a column in results.csv would repeat the value in every row.
class ParameterRecorder final : public Observer {
 public:
  /// Throws InputError if a pattern matches no parameter.
  ParameterRecorder(const ResolvedSystem& system, Ensemble& ensemble, std::filesystem::path file);

  std::optional<std::string> reached(const Point& point) override;

 private:
  const ResolvedSystem* system_;
  Ensemble* ensemble_;
  std::filesystem::path file_;
};

/// Writes the frames in an OSMP binary as PNG files. The name of a file is the time of its frame: `0012.345000.png`
/// contains the frame at 12.345 s.
class PictureRecorder final : public Observer {
 public:
  /// Throws InputError if the frame or its id is not a variable of the required type.
  PictureRecorder(const ResolvedSystem& system, Ensemble& ensemble, const PictureDescription& pictures,
                  std::filesystem::path folder);

  /// Throws Error if the folder cannot be created, if the frame does not consist of whole rows, or if the frame cannot
  /// be written.
  std::optional<std::string> reached(const Point& point) override;
  void visit(state::Visitor& v) override;
  std::string_view state_name() const override { return "pictures"; }

 private:
  void make_folder() const;
  void remove_pictures() const;
  std::span<const std::uint8_t> pixels() const;
  void write(const Point& point) const;

  const Ensemble* ensemble_;
  PictureDescription pictures_;
  TimeGrid grid_;
  std::filesystem::path folder_;
  std::vector<SignalId> frame_;  // a Binary, or the three parts of an OSMP binary
  SignalId id_;
  bool has_folder_ = false;
  std::int64_t last_id_ = 0;
  std::optional<std::int64_t> last_ns_;  // time of the last picture
};

/// Throws InputError if the variables do not exist or have the wrong type, or if the FMU and the config declare
/// different widths.
void check_pictures(const ResolvedSystem& system, const PictureDescription& pictures);

}  // namespace mebots::master
