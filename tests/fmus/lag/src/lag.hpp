// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lag/variables.hpp"
#include "mebots/state/visitor.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace mebots::lag {

/// y' = (gain u - y) / time_constant. Each step uses the exact solution for constant u.
class Lag {
 public:
  /// Reads the label file in `resources`. Throws mebots::Error if the file is missing.
  Lag(Variables& variables, const std::filesystem::path& resources);

  void step(std::int64_t duration_ns);
  void visit(state::Visitor& v);
  std::string history_text() const;

 private:
  void write_outputs();
  std::vector<std::uint8_t>& history() { return histories_[static_cast<std::size_t>(steps_ % 2)]; }
  const std::vector<std::uint8_t>& history() const { return histories_[static_cast<std::size_t>(steps_ % 2)]; }

  Variables& variables_;
  std::string label_;
  std::array<double, channel::kCount> y_v_;
  std::int32_t steps_ = 0;
  std::array<std::vector<std::uint8_t>, 2> histories_;  // alternating, because a reader may use the last one during a
                                                        // step
};

}  // namespace mebots::lag
