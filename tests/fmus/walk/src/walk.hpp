// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"
#include "walk/variables.hpp"

#include <cstdint>

namespace mebots::walk {

/// Moves up or down by one in every step with equal probability. Seed and step determine the direction, so the
/// direction needs no state.
class Walk {
 public:
  explicit Walk(Variables& variables);

  void step();
  void visit(state::Visitor& v);

 private:
  void write_outputs();

  Variables& variables_;
  std::uint64_t steps_ = 0;
  std::int32_t height_ = 0;
  std::int32_t top_ = 0;
};

}  // namespace mebots::walk
