// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "observe/call_tree.hpp"
#include "observe/functions.hpp"
#include "observe/profile_windows.hpp"
#include "observe/text_file.hpp"

#include <span>
#include <string>

namespace mebots::soc::observe {

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
