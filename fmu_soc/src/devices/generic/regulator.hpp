// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/soc/device_kind.hpp"

#include <functional>
#include <string_view>
#include <utility>

namespace mebots::soc {

/// What chip and parts of the board hang on. Its energy is what it takes at its own input: that of its loads over its
/// efficiency.
class Regulator final : public Device {
 public:
  /// Energy of a load up to a time [J].
  using LoadEnergy = std::function<double(std::string_view load, Picoseconds now)>;

  Regulator(const BoardDevice& entry, LoadEnergy load_energy);

  bool load(std::uint32_t /*offset*/, Picoseconds /*now*/, std::uint32_t& /*value*/) override { return false; }
  bool store(std::uint32_t /*offset*/, Picoseconds /*now*/, std::uint32_t /*value*/) override { return false; }
  double energy_j(Picoseconds now) const override;
  void visit(state::Visitor& /*v*/) override {}

 private:
  const BoardDevice& entry_;
  LoadEnergy load_energy_;
};

}  // namespace mebots::soc
