// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "child.hpp"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// The reference traces of an FMU and their comparison with runs, for all FMI versions.
namespace mebots::check {

/// The files of the reference traces: documentation/reference/<name>_in.csv and <name>_out.csv. If they do not exist,
/// extra/org.fmi-standard.fmi-ls-ref/fmi-ls-manifest.xml names the output file, and the _in.csv is in the same folder.
struct TraceFiles {
  std::filesystem::path inputs;  ///< empty if absent
  std::filesystem::path outputs;
  /// True if the same traces belong to the FMI 2.0 and FMI 3.0 versions of a model. Comparisons then ignore columns of
  /// texts, and columns of variables that this FMU lacks.
  bool of_many_versions = false;
};

/// Returns the traces of an unpacked FMU, or nullopt.
std::optional<TraceFiles> find_traces(const std::filesystem::path& folder);

/// The part of the reference traces that can be compared with a run.
struct TraceScope {
  std::string obstacle = {};  ///< reason why nothing can be compared; empty if a column can be compared
  std::size_t columns = 0;    ///< number of output columns; 0 if there is an obstacle
  std::size_t compared = 0;   ///< number of output columns that are numeric variables of this FMU

  /// Returns the name of the check. If not all columns are compared, the name contains their number.
  std::string check_name() const;
};

/// Reads the column names of the traces, and returns which columns can be compared. Ignores an unreadable file, because
/// read_trace() reports it later.
TraceScope trace_scope(const std::optional<TraceFiles>& files,
                       const std::function<bool(const std::string& name)>& is_number);

/// The numeric columns of a trace. A cell contains a number, or the elements of an array separated by blanks.
struct Trace {
  using Cell = std::vector<double>;
  std::vector<std::string> names;
  std::vector<double> times;
  std::vector<std::vector<Cell>> rows;  // indexed by time and column
};

/// Reads the columns for which `is_number` is true. Throws Error if a cell is not a number. If `ignores_others` is
/// false, also throws for any other column.
Trace read_trace(const std::filesystem::path& file, bool ignores_others,
                 const std::function<bool(const std::string& name)>& is_number);

/// Reads the inputs. Without a file of inputs, returns one row without columns. Throws Error if a cell is not a number,
/// or if a column is not a numeric variable of this FMU.
Trace read_inputs(const TraceFiles& files, const std::function<bool(const std::string& name)>& is_number);

/// The functions of an instance that replay() calls.
struct TracedInstance {
  std::function<void()> enter_initialization;
  std::function<void()> exit_initialization;
  std::function<void(const std::string& name, std::span<const double> values)> set;
  std::function<std::vector<double>(const std::string& name)> get;
  std::function<void(double time_s, double step_s)> step;
  std::function<bool()> ended;
  std::function<bool(const std::string& name)> is_real;
};

/// Steps the instance from row to row of `outputs` and compares its outputs. Sets the latest values of `inputs` before
/// each step. Reals may differ by 1e-6 of their value, because compilers round differently; all other values must be
/// equal. Reports the first difference to the witness. Returns true if the run reaches the end of the trace.
bool replay(Witness& witness, const TraceFiles& files, const Trace& inputs, const Trace& outputs,
            const TracedInstance& instance);

}  // namespace mebots::check
