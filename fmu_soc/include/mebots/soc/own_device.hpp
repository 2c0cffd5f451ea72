// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/soc/board_device.hpp"
#include "mebots/soc/device.hpp"

#include <memory>
#include <optional>
#include <string_view>

namespace mebots::soc {

/// A device that the platform knows from the board file only: described wholly there, or with C++ of its own
/// (mebots-boardgen --skeleton). Its variables go in and out by their names.
class OwnDevice : public Device {
 public:
  virtual const BoardDevice& description() const = 0;
  /// False when it senses no such variable.
  virtual bool set_sensed(std::string_view variable, double value) = 0;
  /// What goes out as this variable. Null: nothing does.
  virtual std::optional<double> sent(std::string_view variable) const = 0;
  /// Energy since reset [J], at `now`.
  virtual double energy_j(Picoseconds now) const = 0;
};

/// The devices with C++ of their own of an FMU: null for an entry that is none of them. Defined in the sources that
/// mebots_soc_fmu gets as DEVICES, else in no_own_device.cpp.
std::unique_ptr<OwnDevice> make_own_device(const BoardDevice& entry);

}  // namespace mebots::soc
