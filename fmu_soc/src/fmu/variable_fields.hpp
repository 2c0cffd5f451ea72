// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board/board_file.hpp"
#include "mebots/fmu/fields.hpp"
#include "soc/soc.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::soc {

/// What goes between the FMU's variables and the devices whose entries in the board file name them:
///
///   parameters, inputs -> take() -> devices        at the start of a step
///   devices -> write() -> outputs                  at its end
///
/// The power of a device is the mean over a step, from the energies at its two ends.
class VariableFields {
 public:
  /// `variables` is the instance's generated struct, which must stay where it is. Throws Error naming a variable that
  /// the board file has and the FMU, or the device's kind, does not.
  VariableFields(Soc& soc, void* variables);

  /// Throws Error for an input that is not a number.
  void take();
  void write(double step_s);
  /// The voltage that the chip lives on; nothing when the board does not say.
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
  struct Output {
    const double* from = nullptr;
    fmu::NumberField to;
  };
  struct Energy {
    const Device* device = nullptr;
    std::optional<fmu::NumberField> power_w;
    std::optional<fmu::NumberField> energy_j;
    double before_j = 0;  // at the start of the step
  };

  void find(const DeviceSet::Member& slot, const BoardVariable& variable, void* variables);

  Soc& soc_;
  const double* supply_v_ = nullptr;
  std::vector<Number> numbers_;
  std::vector<Text> texts_;
  std::vector<Bytes> bytes_;
  std::vector<Output> outputs_;
  std::vector<Energy> energies_;
};

}  // namespace mebots::soc
