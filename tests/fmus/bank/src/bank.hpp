// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bank/variables.hpp"
#include "mebots/state/visitor.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace mebots::bank {

/// Independent integrators. Their number is the parameter `lines`.
class Bank {
 public:
  explicit Bank(const Parameters& parameters);

  void start(const Inputs& inputs, Outputs& outputs);
  void step(const Inputs& inputs, std::int64_t duration_ns, Outputs& outputs);
  void visit(state::Visitor& v);

 private:
  void write(const Inputs& inputs, Outputs& outputs);

  Parameters parameters_;
  Outputs* outputs_ = nullptr;
  std::size_t lines_;
  std::array<double, line::kCount> y_m_;
  std::array<std::vector<std::uint8_t>, line::kCount> echo_;
  std::int32_t bytes_ = 0;
};

}  // namespace mebots::bank
