// SPDX-License-Identifier: Apache-2.0
#include "walk.hpp"

#include <algorithm>

namespace mebots::walk {
namespace {

/// The last step of SplitMix64 (Steele, Lea, Flood 2014). Each bit of the result depends on all bits of the key.
std::uint64_t mixed(std::uint64_t key) {
  key += 0x9e3779b97f4a7c15;
  key = (key ^ (key >> 30U)) * 0xbf58476d1ce4e5b9;
  key = (key ^ (key >> 27U)) * 0x94d049bb133111eb;
  return key ^ (key >> 31U);
}

}  // namespace

Walk::Walk(Variables& variables) : variables_(variables) {
  write_outputs();
}

void Walk::step() {
  const auto seed = static_cast<std::uint32_t>(variables_.parameters.seed);
  height_ += (mixed(mixed(seed) ^ steps_) & 1U) != 0 ? 1 : -1;
  ++steps_;
  top_ = std::max(top_, height_);
  write_outputs();
}

void Walk::visit(state::Visitor& v) {
  v("steps", steps_);
  v("height", height_);
  v("top", top_);
}

void Walk::write_outputs() {
  variables_.outputs.height = height_;
  variables_.outputs.top = top_;
}

}  // namespace mebots::walk
