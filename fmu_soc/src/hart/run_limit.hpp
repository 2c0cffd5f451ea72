// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

namespace mebots::soc {

/// Up to where a core runs: every instruction starts before active cycle `end`. With a loose limit, a block that starts
/// before it runs to its end.
class RunLimit {
 public:
  explicit RunLimit(bool loose) : counted_(loose ? 0 : ~std::uint64_t{0}) {}

  bool is_loose() const { return counted_ == 0; }
  void set_end(std::uint64_t cycle) { end_ = std::min(cycle, kLongest); }
  bool reached_at(std::uint64_t cycle) const { return cycle >= end_; }
  std::uint64_t cycles_from(std::uint64_t cycle) const { return end_ - cycle; }
  /// Whether a block may begin in `cycle` whose last instruction starts at most `bound` cycles later.
  bool admits(std::uint64_t cycle, std::uint64_t bound) const { return cycle + (bound & counted_) < end_; }

 private:
  static constexpr std::uint64_t kLongest = std::uint64_t{1} << 62;  // more than any core will see

  std::uint64_t end_ = 0;
  std::uint64_t counted_;  // the bits of a bound that count
};

}  // namespace mebots::soc
