// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmu_soc/variables.hpp"
#include "mebots/state/visitor.hpp"
#include "observe/session.hpp"
#include "soc.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::soc {

/// Where the FMU keeps the variables that only the board file names; null for a name that it does not have.
struct Fields {
  std::function<const double*(std::string_view)> input = [](std::string_view) { return nullptr; };
  std::function<double*(std::string_view)> output = [](std::string_view) { return nullptr; };
};

/// The chip as the FMU's variables see it: parameters and inputs go to the devices, devices and ledger to the
/// outputs. Plain C++; fmu.cpp binds it to FMI.
///
/// Inputs are sampled at the start of a step and hold for the instructions that start after it, up to and with the
/// step's end. What those instructions ask for is in the outputs at the end.
class Model {
 public:
  /// Below this bus voltage the chip's converter gives up: the chip loses power and stays without until reset.
  static constexpr double kPowerLossVoltageV = 2.5;

  /// Reads the board file in `resources`, and the firmware: the parameter's file, or the one in `resources`. The fields
  /// are asked for the variables of the board's own devices, and must stay where they are.
  /// Throws Error naming parameter or file, value and limit.
  Model(const Parameters& parameters, const std::filesystem::path& resources, Listeners listeners,
        const Fields& fields = {});
  /// Finishes what the observe.* parameters asked for.
  ~Model();
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  /// Writes the outputs at the start.
  void start(const Inputs& inputs, std::int64_t start_ns, Outputs& outputs);
  /// Goes from start_ns to start_ns + duration_ns (> 0). Throws Error for an input that is no number.
  void step(const Inputs& inputs, std::int64_t start_ns, std::int64_t duration_ns, Outputs& outputs);

  void visit(state::Visitor& v);

  const Soc& soc() const { return soc_; }

 private:
  /// A device of the board's own and its outputs; null where the board file names none.
  struct Own {
    const OwnDevice* device = nullptr;
    double* power_w = nullptr;
    double* energy_j = nullptr;
    double energy_before_j = 0;  // at the start of the step
  };
  struct Sensed {
    std::string name;
    const double* value = nullptr;
  };
  struct Sent {
    const OwnDevice* device = nullptr;
    std::string name;
    double* value = nullptr;
  };

  void find_fields(const Fields& fields);
  void take_inputs(const Inputs& inputs);
  void write(Outputs& outputs) const;
  void say_when_spinning();

  Listeners listeners_;
  Soc soc_;
  std::unique_ptr<observe::Session> session_;
  bool said_spinning_ = false;
  std::int64_t origin_ns_ = 0;
  std::vector<std::uint8_t> decoded_;
  std::vector<Own> own_;
  std::vector<Sensed> sensed_;
  std::vector<Sent> sent_;
};

}  // namespace mebots::soc
