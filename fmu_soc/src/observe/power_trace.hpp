// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "observe/power_formats.hpp"
#include "soc/soc.hpp"
#include "soc/state_times.hpp"

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::soc::observe {

/// States of core and devices, clock, voltage, and power by component, over time.
///
/// Power is the mean between two readings of the ledger. It is read whenever something happens, but not before
/// kShortest is over; so the area under the curve is the energy, and a file stays readable.
class PowerTrace final : public StateListener {
 public:
  static constexpr Picoseconds kShortest = 10'000'000;  // 10 us

  /// `option` names in errors who asked for the file. .json is for Perfetto (Chrome's trace events), .vcd for GTKWave.
  /// Throws Error for another ending and for a file that cannot be written.
  PowerTrace(const std::string& option, const std::string& path, const Soc& soc);

  void changed(Picoseconds time) override;
  /// The chip was put into an earlier state: power is counted from there. Time in the file does not go back, so that
  /// nothing is written until the chip is again where it has been.
  void restored();
  /// Writes up to now. Throws Error when that fails.
  void finish();

 private:
  struct Change {
    Picoseconds time = 0;
    std::size_t track = 0;
    std::string_view state;
  };

  void note_states(Picoseconds time);
  void close_span(Picoseconds time);
  std::vector<double> energies(Picoseconds time) const;

  const Soc& soc_;
  std::unique_ptr<PowerWriter> writer_;
  std::vector<std::string_view> states_;  // by track: the last one noted
  std::vector<Change> waiting_;           // changes of state inside the open span
  Picoseconds span_start_ = 0;
  std::vector<double> span_energies_j_;
  double span_clock_hz_ = 0;
  double span_voltage_v_ = 0;
};

}  // namespace mebots::soc::observe
