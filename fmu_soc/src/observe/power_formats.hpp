// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "clock/clock.hpp"

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::soc::observe {

/// Puts states (of tracks) and values (of channels) over time into a file. Calls come in the order of time.
class PowerWriter {
 public:
  PowerWriter() = default;
  PowerWriter(const PowerWriter&) = delete;
  PowerWriter& operator=(const PowerWriter&) = delete;
  virtual ~PowerWriter() = default;

  /// From `time` on, the track is in this state.
  virtual void state(Picoseconds time, std::size_t track, std::string_view name) = 0;
  /// From `time` on, the channel has this value.
  virtual void value(Picoseconds time, std::size_t channel, double value) = 0;
  /// Everything ends. Throws Error when something could not be written.
  virtual void finish(Picoseconds time) = 0;
};

/// A writer by the ending of the path: .json for Perfetto and Chrome ("Trace Event Format", JSON object form), .vcd for
/// GTKWave (IEEE 1364, value change dump, with GTKWave's string variables). Channels are named "name [unit]".
/// Throws Error, naming `option`, for another ending and for a file that cannot be written.
std::unique_ptr<PowerWriter> make_power_writer(const std::string& option, const std::string& path,
                                               std::vector<std::string> tracks, std::vector<std::string> channels);

}  // namespace mebots::soc::observe
