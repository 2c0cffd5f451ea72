// SPDX-License-Identifier: Apache-2.0
#include "devices/generic/console.hpp"

#include "devices/core/kinds.hpp"
#include "fmu_soc_board/board.hpp"

namespace mebots::soc {

Console::Console(DeviceHost& host) : host_(host) {
  line_.reserve(kMaxLine);
}

bool Console::load(std::uint32_t /*offset*/, Picoseconds /*now*/, std::uint32_t& /*value*/) {
  return false;
}

bool Console::store(std::uint32_t offset, Picoseconds now, std::uint32_t value) {
  return offset == board::console::kPutchar && put(value, now);
}

bool Console::put(std::uint32_t value, Picoseconds /*now*/) {
  const auto character = static_cast<char>(value & 0xffU);
  if (character != '\n') line_ += character;
  if (character == '\n' || line_.size() == kMaxLine) {
    host_.print(line_);
    line_.clear();
  }
  return true;
}

void Console::program_ended() {
  if (!line_.empty()) host_.print(line_);
  line_.clear();
}

void Console::visit(state::Visitor& v) {
  v("line", line_);
}

}  // namespace mebots::soc

MEBOTS_CHIP_KIND(console, board::console::kRegisters,
                 [](const BoardDevice& /*entry*/, ChipHost& host) -> std::unique_ptr<Device> {
                   return std::make_unique<Console>(host);
                 })
