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

/// Writes the states of tracks and the values of channels over time into a file. Calls must be in the order of time.
class PowerWriter {
 public:
  PowerWriter() = default;
  PowerWriter(const PowerWriter&) = delete;
  PowerWriter& operator=(const PowerWriter&) = delete;
  virtual ~PowerWriter() = default;

  virtual void state(Picoseconds time, std::size_t track, std::string_view name) = 0;
  virtual void value(Picoseconds time, std::size_t channel, double value) = 0;
  /// Throws Error if a part of the file could not be written.
  virtual void finish(Picoseconds time) = 0;
};

/// Returns the writer that the extension of `path` selects: .json for Perfetto and Chrome ("Trace Event Format", JSON
/// object form), .vcd for GTKWave (IEEE 1364, value change dump, with GTKWave's string variables). Names of channels
/// have the form "name [unit]". If the extension is another one, or if the file cannot be written, throws Error that
/// names `option`.
std::unique_ptr<PowerWriter> make_power_writer(const std::string& option, const std::string& path,
                                               std::vector<std::string> tracks, std::vector<std::string> channels);

struct HartTree {
  unsigned number = 0;
  std::string name;  // name of the hart; empty for the fabric controller
  const CallTree* tree = nullptr;
};

/// Writes three profiles for each hart (time [ns], energy [nJ], cycles) that have the same call tree. Children are in
/// the order of their creation. Format: speedscope's file-format-schema.json, profiles of type "evented".
///
/// The additional key "mebots" contains data for the page of `mebots report`. `harts` has `name` and `nodes`: one list
/// that contains parent and frame of each node. Node 0 is the root and its own parent. `windows` has `from` and `to`
/// [ns] and `parts`: one list that contains hart, node, cycles, ps and fJ. These are the costs of the node without its
/// children.
void write_speedscope(std::span<const HartTree> harts, const Functions& functions,
                      std::span<const ProfileWindows::Window> windows, const std::string& program, TextFile& file);

/// Writes the self and inclusive costs of each function and each call: cycles, instructions, ps and fJ. Each hart is a
/// thread in the file. Format: Valgrind's "Callgrind Format Specification", version 1.
void write_callgrind(std::span<const HartTree> harts, const Functions& functions, const std::string& program,
                     TextFile& file);

}  // namespace mebots::soc::observe
