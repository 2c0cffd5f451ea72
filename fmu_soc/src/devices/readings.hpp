// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/soc/device.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace mebots::soc {

/// A device of read-only registers, one word each from offset 0: values that the surroundings set.
template <std::size_t Count>
class Readings : public Device {
 public:
  bool load(std::uint32_t offset, Picoseconds /*now*/, std::uint32_t& value) override {
    if (offset / 4 >= Count) return false;
    value = words_[offset / 4];
    return true;
  }
  bool store(std::uint32_t /*offset*/, Picoseconds /*now*/, std::uint32_t /*value*/) override { return false; }
  void visit(state::Visitor& v) override { v("words", words_); }

 protected:
  void set(std::uint32_t offset, std::uint32_t word) { words_[offset / 4] = word; }

 private:
  std::array<std::uint32_t, Count> words_{};
};

}  // namespace mebots::soc
