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

/// Declares the reference traces of an FMU, and compares runs with them, for all FMI versions.
namespace mebots::check {

/// The files that contain the reference traces: `documentation/reference/<name>_in.csv` and `<name>_out.csv`. If these
/// do not exist, `extra/org.fmi-standard.fmi-ls-ref/fmi-ls-manifest.xml` names the output file, and the `_in.csv` is in
/// the same folder.
struct TraceFiles {
  std::filesystem::path inputs;  ///< empty if absent
  std::filesystem::path outputs;
  /// True if the files serve both the FMI 2.0 and the FMI 3.0 version of a model. In this case, columns are ignored if
  /// this FMU has no such variable or if the variable is a text.
  bool of_many_versions = false;
};

/// Returns the traces of an unpacked FMU. Returns nullopt if it has none.
std::optional<TraceFiles> find_traces(const std::filesystem::path& folder);

/// States which part of the reference traces can be compared with a run.
struct TraceScope {
  std::string obstacle = {};  ///< why nothing can be compared; empty if at least one column can be compared
  std::size_t columns = 0;    ///< number of output columns; 0 if there is an obstacle
  std::size_t compared = 0;   ///< number of output columns that are numeric variables of this FMU

  /// Returns the name of the check. If some columns are not compared, the name contains the number of compared columns.
  std::string check_name() const;
};

/// Reads the column names of the traces. An unreadable file is no obstacle, because read_trace() throws an error for
/// it.
TraceScope trace_scope(const std::optional<TraceFiles>& files,
                       const std::function<bool(const std::string& name)>& is_number);

/// The numeric columns of a trace. A cell contains one number, or the elements of an array, separated by blanks.
struct Trace {
  using Cell = std::vector<double>;
  std::vector<std::string> names;
  std::vector<double> times;
  std::vector<std::vector<Cell>> rows;  // indexed by time and column
};

/// Reads the columns for which `is_number` is true. Throws Error if one of their cells is not a number. If
/// `ignores_others` is false, also throws if the file has any other column.
Trace read_trace(const std::filesystem::path& file, bool ignores_others,
                 const std::function<bool(const std::string& name)>& is_number);

/// Reads the file of inputs. If `files` has no inputs, returns a trace that has one row and no columns. Throws Error if
/// a cell is not a number, or if a column is not a numeric variable of this FMU.
Trace read_inputs(const TraceFiles& files, const std::function<bool(const std::string& name)>& is_number);

/// The functions of an FMU's instance that replay() calls.
struct TracedInstance {
  std::function<void()> enter_initialization;
  std::function<void()> exit_initialization;
  std::function<void(const std::string& name, std::span<const double> values)> set;
  std::function<std::vector<double>(const std::string& name)> get;
  std::function<void(double time_s, double step_s)> step;
  std::function<bool()> ended;  ///< true if the FMU has ended the run
  std::function<bool(const std::string& name)> is_real;
};

/// Steps the instance from row to row of `outputs` and compares its outputs with the row. Sets the latest inputs of
/// `inputs` before each step. Reals may differ by 1e-6 of their value, because compilers round differently; all other
/// values must be equal. Reports the first difference to the witness. Returns true if the run reaches the end of the
/// trace.
bool replay(Witness& witness, const TraceFiles& files, const Trace& inputs, const Trace& outputs,
            const TracedInstance& instance);

}  // namespace mebots::check
