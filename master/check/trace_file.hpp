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

/// Reference traces inside an FMU, and the comparison of a run with them, for any version of FMI.
namespace mebots::check {

/// The files of the reference traces: `documentation/reference/<name>_in.csv` and `<name>_out.csv`. Otherwise the
/// result named in `extra/org.fmi-standard.fmi-ls-ref/fmi-ls-manifest.xml`, with its `_in.csv` in the same folder.
struct TraceFiles {
  std::filesystem::path inputs;  ///< empty if absent
  std::filesystem::path outputs;
  /// True if the file serves the FMI 2.0 and 3.0 versions of a model. In this case, columns for variables that this FMU
  /// lacks, or has as text, are ignored.
  bool of_many_versions = false;
};

/// Returns the traces of an unpacked FMU, if it has any.
std::optional<TraceFiles> find_traces(const std::filesystem::path& folder);

/// The part of the reference traces with which a run can be compared.
struct TraceScope {
  std::string obstacle = {};  ///< reason why nothing can be compared; empty if something can
  std::size_t columns = 0;    ///< number of output columns; 0 with an obstacle
  std::size_t compared = 0;   ///< number of output columns that are numbers of this FMU

  /// Returns the name of the check. If some columns are not compared, the name contains the number of compared columns.
  std::string check_name() const;
};

/// Reads the names of the columns. If a file cannot be read, there is no obstacle: read_trace() throws the error.
TraceScope trace_scope(const std::optional<TraceFiles>& files,
                       const std::function<bool(const std::string& name)>& is_number);

/// Numeric columns of a trace. A cell is a number, or the numbers of an array separated by blanks.
struct Trace {
  using Cell = std::vector<double>;
  std::vector<std::string> names;
  std::vector<double> times;
  std::vector<std::vector<Cell>> rows;  // by time and column
};

/// Returns the columns for which `is_number` is true. Throws Error if a cell is not a number. Unless `ignores_others`
/// is true, also throws if there is any other column.
Trace read_trace(const std::filesystem::path& file, bool ignores_others,
                 const std::function<bool(const std::string& name)>& is_number);

/// Reads the inputs of the traces. If there is no file of inputs, returns a trace of one row without columns. Throws
/// Error if a cell is not a number, or if a column is not a numeric variable of this FMU.
Trace read_inputs(const TraceFiles& files, const std::function<bool(const std::string& name)>& is_number);

/// The functions of an instance that replay() calls.
struct TracedInstance {
  std::function<void()> enter_initialization;
  std::function<void()> exit_initialization;
  std::function<void(const std::string& name, std::span<const double> values)> set;
  std::function<std::vector<double>(const std::string& name)> get;
  std::function<void(double time_s, double step_s)> step;
  std::function<bool()> ended;  ///< true if the FMU has ended the run
  std::function<bool(const std::string& name)> is_real;
};

/// Steps from row to row of the output file with the latest inputs, and compares. Reals may differ by 1e-6 of their
/// value, because compilers round differently; all other values must be equal. Reports the first divergence to the
/// witness. Returns true if the run reaches the end of the trace.
bool replay(Witness& witness, const TraceFiles& files, const Trace& inputs, const Trace& outputs,
            const TracedInstance& instance);

}  // namespace mebots::check
