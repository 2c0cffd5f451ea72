// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmu/variable_fields.hpp"
#include "fmu_soc/variables.hpp"
#include "mebots/state/visitor.hpp"
#include "observe/session.hpp"
#include "soc/soc.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>

namespace mebots::soc {

/// The chip as the FMU's variables see it: parameters and inputs go to the devices, devices and ledger to the
/// outputs. Plain C++; fmu.cpp binds it to FMI.
///
/// Inputs are sampled at the start of a step and hold for the instructions that start after it, up to and with the
/// step's end. What those instructions ask for is in the outputs at the end.
class Model {
 public:
  /// Reads the board file in `resources`, and the firmware: the parameter's file, or the one in `resources`. The
  /// variables of the board's devices are found in `variables`, which must stay where it is.
  /// Throws Error naming parameter or file, value and limit.
  Model(Variables& variables, const std::filesystem::path& resources, Listeners listeners);
  /// Finishes what the observe.* parameters asked for.
  ~Model();
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  /// Writes the outputs at the start.
  void start(std::int64_t start_ns);
  /// Goes from start_ns to start_ns + duration_ns (> 0). Throws Error for an input that is not a number.
  void step(std::int64_t start_ns, std::int64_t duration_ns);

  void visit(state::Visitor& v);

  const Soc& soc() const { return soc_; }

 private:
  Model(Variables& variables, const std::filesystem::path& resources, const BoardDescription& board,
        Listeners listeners);

  void take_inputs();
  void write(double step_s);
  void write_decisions();
  void report_spinning();

  Variables& variables_;
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
