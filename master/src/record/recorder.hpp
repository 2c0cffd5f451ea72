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

/// Records a row at each communication point, or at each recording interval. The first row is at the start, the last
/// row at the end of the run. Another thread writes the files.
class Recorder final : public Observer {
 public:
  /// Throws InputError if a pattern in the config matches no variable.
  Recorder(const ResolvedSystem& system, Ensemble& ensemble);

  /// Adds a destination for the rows. Must be called before the first point.
  void add(std::unique_ptr<RowSink> sink);

  std::optional<std::string> reached(const Point& point) override;
  void ended(const Point& point) override;
  /// Writes all rows so far to the sinks. Throws Error if a sink cannot write, for example because the disk is full.
  void flush() { writer_.drain(block_); }
  void visit(state::Visitor& v) override;
  std::string_view state_name() const override { return "recorder"; }

  const std::vector<RecordColumn>& columns() const { return columns_; }
  std::int64_t rows() const { return rows_; }

 private:
  /// The address of a column's value. Exactly one pointer is not null.
  struct Source {
    const double* real = nullptr;
    const std::int64_t* integer = nullptr;
    bool binary = false;  // true if `text` contains bytes, which are recorded as hexadecimal digits
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
  bool records_step_ = false;             // true if the first column is the length of the step
  double step_s_ = 0;                     // length of the step that ends at this point [s]; 0 at the start
  std::optional<std::int64_t> point_ns_;  // time of the previous point; only if records_step_ is true
  std::vector<Source> sources_;           // set at the first row
  RowBlock block_;
  std::size_t text_bytes_ = 0;  // number of text bytes in `block_`
  std::vector<std::unique_ptr<RowSink>> sinks_;
  BlockWriter writer_;  // must be destroyed before the sinks
  std::int64_t rows_ = 0;
  std::int64_t last_step_ = -1;
};

/// Reads the recorded parameters from the slaves. All slaves must be initialised.
std::vector<ParameterValue> read_parameters(const ResolvedSystem& system, Ensemble& ensemble);

/// Writes name, unit and value of each recorded parameter to parameters.csv at the start.
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

/// Writes the frames of a camera as PNG files. The name of a file is the time in seconds, such as 0012.345000.png.
class PictureRecorder final : public Observer {
 public:
  /// Throws InputError if the frame or its id does not exist or has the wrong type.
  PictureRecorder(const ResolvedSystem& system, Ensemble& ensemble, const PictureDescription& pictures,
                  std::filesystem::path folder);

  /// Throws Error if the folder or a file cannot be written, or if the frame does not consist of whole rows.
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
  std::vector<SignalId> frame_;  // a Binary, or the three variables of an OSMP binary
  SignalId id_;
  bool has_folder_ = false;
  std::int64_t last_id_ = 0;
  std::optional<std::int64_t> last_ns_;
};

/// Throws InputError if a variable does not exist or has the wrong type, or if FMU and config declare different widths.
void check_pictures(const ResolvedSystem& system, const PictureDescription& pictures);

}  // namespace mebots::master
