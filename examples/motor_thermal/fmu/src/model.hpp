// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"
#include "motor_thermal/variables.hpp"

#include <cstdint>
#include <filesystem>

namespace mebots::motor_thermal {

/// The temperatures of a motor. The winding (w) and the case (c) around it are heat capacities:
///
///     C_w dT_w/dt = I^2 R (1 + a (T_w - 20 degC)) - G_w (T_w - T_c)
///     C_c dT_c/dt = G_w (T_w - T_c) - G_c (T_c - T_air)
///
/// For constant inputs, these equations are linear in (T_w, T_c), so a step of any length is the exact solution.
class Model {
 public:
  /// `resources` is not used. The FMI functions have checked each parameter against its limits in the description.
  Model(const Parameters& parameters, const std::filesystem::path& resources);

  void start(const Inputs& inputs, Outputs& outputs);
  /// Advances by duration_ns with constant inputs. duration_ns must be positive. Throws mebots::Error if the
  /// temperature of the winding rises without limit.
  void step(const Inputs& inputs, std::int64_t duration_ns, Outputs& outputs);

  void visit(state::Visitor& v);

 private:
  void write(Outputs& outputs) const;

  Parameters parameters_;
  double winding_k_;
  double case_k_;
  double current_a_ = 0;
  double copper_j_ = 0;
  double air_j_ = 0;
};

}  // namespace mebots::motor_thermal
