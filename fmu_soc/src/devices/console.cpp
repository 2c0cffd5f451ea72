// SPDX-License-Identifier: Apache-2.0
#include "devices/console.hpp"

#include "fmu_soc_board/board.hpp"

namespace mebots::soc {

Console::Console(Sink sink) : sink_(std::move(sink)) {
  line_.reserve(kMaxLine);
}

bool Console::load(std::uint32_t /*offset*/, Picoseconds /*now*/, std::uint32_t& /*value*/) {
  return false;
}

bool Console::store(std::uint32_t offset, Picoseconds /*now*/, std::uint32_t value) {
  if (offset != board::console::kPutchar) return false;
  const auto character = static_cast<char>(value & 0xffU);
  if (character != '\n') line_ += character;
  if (character == '\n' || line_.size() == kMaxLine) {
    if (sink_) sink_(line_);
    line_.clear();
  }
  return true;
}

void Console::flush() {
  if (!line_.empty() && sink_) sink_(line_);
  line_.clear();
}

void Console::visit(state::Visitor& v) {
  v("line", line_);
}

}  // namespace mebots::soc
