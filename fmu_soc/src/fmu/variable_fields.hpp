// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board/board_file.hpp"
#include "mebots/fmu/fields.hpp"
#include "soc/soc.hpp"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::soc {

/// Parameters and inputs of a communication step. Successive steps share equal texts and bytes.
struct StepInputs {
  std::vector<double> numbers;
  std::vector<std::shared_ptr<const std::string>> texts;
  std::vector<std::shared_ptr<const std::vector<std::uint8_t>>> bytes;
};

/// Copies values between the FMU's variables and the devices. The entries of the board file define the variables:
///
///   parameters, inputs -> take() -> devices        at the start of a step
///   devices -> write() -> outputs                  at its end
///
/// The power of a device is its mean over a step, computed from the energies at the start and at the end.
class VariableFields {
 public:
  /// `variables` is the generated struct of the FMU instance, and must not move. Throws Error if the FMU, or the kind
  /// of a device, lacks a variable of the board file.
  VariableFields(Soc& soc, void* variables);

  /// Passes the parameters and inputs to the devices. Throws Error if a number is not finite.
  void take();
  /// Returns the values that take() has just passed to the devices. `before` contains the inputs of the previous step,
  /// or is null.
  StepInputs inputs(const StepInputs* before) const;
  /// Passes the inputs of an earlier step to the devices. `inputs` must stay valid until begin_step() of the devices
  /// has returned.
  void set(const StepInputs& inputs);
  void write(double step_s);
  /// Returns the supply voltage of the chip, or null if the board has no supply.
  const double* supply_v() const { return supply_v_; }

 private:
  struct Number {
    std::string name;
    fmu::NumberField from;
    double* to = nullptr;
  };
  struct Text {
    const std::string* from = nullptr;
    std::string_view* to = nullptr;
  };
  struct Bytes {
    const fmu::BinaryRef* from = nullptr;
    std::span<const std::uint8_t>* to = nullptr;
  };
  struct TextOutput {
    const std::string* from = nullptr;
    std::string* to = nullptr;
  };
  struct Output {
    const double* from = nullptr;
    fmu::NumberField to;
  };
  struct Energy {
    const Device* device = nullptr;
    std::optional<fmu::NumberField> power_w;
    std::optional<fmu::NumberField> energy_j;
    double before_j = 0;  // energy at the start of the step
  };

  void find(const DeviceSet::Member& slot, const BoardVariable& variable, void* variables);
  void begin_energies();

  Soc& soc_;
  const double* supply_v_ = nullptr;
  std::vector<Number> numbers_;
  std::vector<Text> texts_;
  std::vector<Bytes> bytes_;
  std::vector<Output> outputs_;
  std::vector<TextOutput> text_outputs_;
  std::vector<Energy> energies_;
};

}  // namespace mebots::soc
