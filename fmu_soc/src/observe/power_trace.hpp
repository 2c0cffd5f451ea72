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

/// Records over time: the states of cores and devices, the clock, the voltage, and the power of each component.
class PowerTrace final : public StateListener {
 public:
  static constexpr Picoseconds kShortest = 10'000'000;  // 10 us

  /// `option` is the command-line option for error messages. The extension of `path` selects the format: .json for
  /// Perfetto (Chrome's trace events), .vcd for GTKWave. Throws Error if the extension is another one, or if the file
  /// cannot be written.
  PowerTrace(const std::string& option, const std::string& path, const Soc& soc);

  void changed(Picoseconds time) override;
  /// Must be called after the chip was restored to an earlier state. Writes nothing until the chip has reached the last
  /// time in the file again, because times in the file must not decrease.
  void restored();
  /// Throws Error if a part of the file could not be written.
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
  std::vector<std::string_view> states_;  // state that was written last, for each track
  std::vector<Change> waiting_;           // changes of state in the span that is not written yet
  Picoseconds span_start_ = 0;
  std::vector<double> span_energies_j_;
  double span_clock_hz_ = 0;
  double span_voltage_v_ = 0;
};

}  // namespace mebots::soc::observe
