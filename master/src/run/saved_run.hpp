// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace mebots::master {

/// A run without files as it stood at one communication point: other runs of the same inputs begin there. (A Checkpoint
/// is for the same run, whose files hold what came before.)
struct SavedRun {
  std::string inputs;  ///< the lines that the hash of the inputs is made of
  std::int64_t time_ns = 0;
  std::vector<std::byte> simulation;
  std::vector<std::byte> rows;  ///< of the MemorySink, if there is one

  void visit(state::Visitor& v) {
    v("inputs", inputs);
    v("time_ns", time_ns);
    v("simulation", simulation);
    v("rows", rows);
  }
};

std::vector<std::byte> to_bytes(const SavedRun& run);
/// Throws InputError for bytes that to_bytes() of this version did not make.
SavedRun saved_run(std::span<const std::byte> bytes);

}  // namespace mebots::master
