// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "clock/clock.hpp"
#include "observe/call_tree.hpp"
#include "observe/functions.hpp"
#include "observe/profile.hpp"
#include "observe/text_file.hpp"

#include <cstddef>
#include <memory>
#include <span>
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

struct HartTree {
  unsigned number = 0;
  std::string name;  // empty for the fabric controller
  const CallTree* tree = nullptr;
};

/// By hart three profiles, time [ns], energy [nJ] and cycles, over the same call tree, children in the order of their
/// coming. Format: speedscope's file-format-schema.json, profiles of type "evented".
///
/// Beside what speedscope reads stands "mebots", for our page: `harts`, each with `name` and `nodes` (parent and
/// frame of each, in one list; node 0 is the root, its own parent), and `windows`, each with `from` and `to` [ns] and
/// `parts`: hart, node, cycles, ps and fJ of a node's own, one after the other in one list.
void write_speedscope(std::span<const HartTree> harts, const Functions& functions,
                      std::span<const ProfileWindows::Window> windows, const std::string& program, TextFile& file);

/// Self and inclusive costs by function and by call: cycles, instructions, ps and fJ. A part of the file by hart, as a
/// thread.
/// Format: Valgrind's "Callgrind Format Specification", version 1.
void write_callgrind(std::span<const HartTree> harts, const Functions& functions, const std::string& program,
                     TextFile& file);

}  // namespace mebots::soc::observe
