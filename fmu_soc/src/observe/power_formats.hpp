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

/// Writes states of tracks and values of channels over time into a file. Calls must be in the order of time.
class PowerWriter {
 public:
  PowerWriter() = default;
  PowerWriter(const PowerWriter&) = delete;
  PowerWriter& operator=(const PowerWriter&) = delete;
  virtual ~PowerWriter() = default;

  /// Sets the state of a track from `time` on.
  virtual void state(Picoseconds time, std::size_t track, std::string_view name) = 0;
  /// Sets the value of a channel from `time` on.
  virtual void value(Picoseconds time, std::size_t channel, double value) = 0;
  /// Ends the file. Throws Error if something could not be written.
  virtual void finish(Picoseconds time) = 0;
};

/// Returns the writer for the path's extension: .json for Perfetto and Chrome ("Trace Event Format", JSON object form),
/// .vcd for GTKWave (IEEE 1364, value change dump, with GTKWave's string variables). Names of channels are "name
/// [unit]". For another extension, or if the file cannot be written, throws Error that names `option`.
std::unique_ptr<PowerWriter> make_power_writer(const std::string& option, const std::string& path,
                                               std::vector<std::string> tracks, std::vector<std::string> channels);

struct HartTree {
  unsigned number = 0;
  std::string name;  // empty for the fabric controller
  const CallTree* tree = nullptr;
};

/// Writes three profiles per hart (time [ns], energy [nJ], cycles) over the same call tree; children are in the order
/// of their creation. Format: speedscope's file-format-schema.json, profiles of type "evented".
///
/// The additional key "mebots" is for the page of `mebots report`. `harts` have `name` and `nodes`: parent and frame of
/// each node in one list; node 0 is the root and its own parent. `windows` have `from` and `to` [ns] and `parts`: hart,
/// node, cycles, ps and fJ of the node alone, in one list.
void write_speedscope(std::span<const HartTree> harts, const Functions& functions,
                      std::span<const ProfileWindows::Window> windows, const std::string& program, TextFile& file);

/// Writes self and inclusive costs by function and by call: cycles, instructions, ps and fJ. Each hart is a thread in
/// the file. Format: Valgrind's "Callgrind Format Specification", version 1.
void write_callgrind(std::span<const HartTree> harts, const Functions& functions, const std::string& program,
                     TextFile& file);

}  // namespace mebots::soc::observe
