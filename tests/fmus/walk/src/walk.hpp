// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"
#include "walk/variables.hpp"

#include <cstdint>

namespace mebots::walk {

/// Up one or down one in every step, as likely. The coin of a step is a function of seed and step alone: it needs no
/// state.
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
