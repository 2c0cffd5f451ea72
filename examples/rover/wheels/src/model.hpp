// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"
#include "rover_wheels/variables.hpp"

#include <cstdint>
#include <filesystem>

namespace mebots::rover_wheels {

/// Two wheels on one axis, which roll without slip.
///
/// The speed u of a rim follows its command c: u' = (c - u) / lag. For a constant command, speed and distance of a step
/// are exact. The pose moves along the chord at the mean heading of the step, which gives an error of third order in
/// the turn.
class Model {
 public:
  /// `resources` is not used. The FMI functions have checked each parameter against its limits in the description.
  Model(const Parameters& parameters, const std::filesystem::path& resources);

  void start(const Inputs& inputs, Outputs& outputs);
  /// Advances by duration_ns with constant inputs. duration_ns must be positive.
  void step(const Inputs& inputs, std::int64_t duration_ns, Outputs& outputs);

  void visit(state::Visitor& v);

 private:
  struct Wheel {
    double speed_m_per_s = 0;
    double way_m = 0;

    /// Advances the wheel. Returns the distance of its rim.
    double step(double command_m_per_s, double duration_s, double lag_s);
    void visit(state::Visitor& v);
  };

  void write(Outputs& outputs) const;

  Parameters parameters_;
  Wheel left_;
  Wheel right_;
  double x_m_ = 0;
  double y_m_ = 0;
  double yaw_rad_ = 0;
};

}  // namespace mebots::rover_wheels
