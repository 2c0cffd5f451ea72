// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmu/past.hpp"
#include "fmu/variable_fields.hpp"
#include "fmu_soc/variables.hpp"
#include "mebots/state/visitor.hpp"
#include "observe/session.hpp"
#include "soc/soc.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace mebots::soc {

/// Connects the chip with the FMU's variables: passes parameters and inputs to the devices, and sets the outputs. Does
/// not use FMI; fmu.cpp does.
///
/// Inputs are read at the start of a step. They apply to the instructions that start after that time, up to and
/// including the end of the step.
class Model {
 public:
  /// Reads the board file in `resources`, and the firmware: the file that the parameter names, or by default a file in
  /// `resources`. `variables` contains the variables of the board's devices, and must not move. Throws Error that names
  /// the parameter or file, the value and the limit.
  Model(Variables& variables, const std::filesystem::path& resources, Listeners listeners);
  /// Completes the files that the parameters observe.* have requested.
  ~Model();
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  /// Writes the initial outputs.
  void start(std::int64_t start_ns);
  /// Advances the chip from start_ns to start_ns + duration_ns. duration_ns must be above 0. Throws Error if an input
  /// is not finite.
  void step(std::int64_t start_ns, std::int64_t duration_ns);

  void visit(state::Visitor& v);

  const Soc& soc() const { return soc_; }

 private:
  Model(Variables& variables, const std::filesystem::path& resources, const BoardDescription& board,
        Listeners listeners);

  void take_inputs();
  void begin_step();
  void advance(std::int64_t end_ns);
  void replay();
  void write(double step_s);
  void write_decisions();
  void report_spinning();

  Variables& variables_;
  std::optional<Past> past_;  // set if a debugger can return to earlier instructions
  Listeners listeners_;
  std::string energies_;
  Chip chip_;
  Soc soc_;
  VariableFields fields_;
  std::unique_ptr<observe::Session> session_;
  bool spinning_reported_ = false;
  std::int64_t origin_ns_ = 0;
};

}  // namespace mebots::soc
