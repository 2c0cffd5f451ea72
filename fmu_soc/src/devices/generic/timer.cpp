// SPDX-License-Identifier: Apache-2.0
#include "devices/generic/timer.hpp"

#include "devices/core/kinds.hpp"
#include "fmu_soc_board/board.hpp"

namespace mebots::soc {

bool Timer::load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) {
  const auto time_ns = static_cast<std::uint64_t>(now / kPsPerNs);
  switch (offset) {
    case board::timer::kTimeLo:
      latched_high_ = static_cast<std::uint32_t>(time_ns >> 32);
      value = static_cast<std::uint32_t>(time_ns);
      return true;
    case board::timer::kTimeHi:
      value = latched_high_;
      return true;
    case board::timer::kCompareLo:
      value = static_cast<std::uint32_t>(compare_ns_);
      return true;
    case board::timer::kCompareHi:
      value = static_cast<std::uint32_t>(compare_ns_ >> 32);
      return true;
    default:
      return false;
  }
}

bool Timer::store(std::uint32_t offset, Picoseconds now, std::uint32_t value) {
  if (offset == board::timer::kCompareLo) {
    compare_ns_ = (compare_ns_ & ~std::uint64_t{0xffffffffU}) | value;
  } else if (offset == board::timer::kCompareHi) {
    compare_ns_ = (compare_ns_ & 0xffffffffU) | (std::uint64_t{value} << 32);
  } else {
    return false;
  }
  due_ = now >= compare_ps();
  return true;
}

Picoseconds Timer::compare_ps() const {
  if (compare_ns_ > static_cast<std::uint64_t>(kNever / kPsPerNs)) return kNever;
  return static_cast<Picoseconds>(compare_ns_) * kPsPerNs;
}

void Timer::advance(Picoseconds now) {
  due_ = now >= compare_ps();
}

Picoseconds Timer::next_event() const {
  return due_ ? kNever : compare_ps();
}

void Timer::visit(state::Visitor& v) {
  v("compare_ns", compare_ns_);
  v("latched_high", latched_high_);
  v("due", due_);
}

}  // namespace mebots::soc

MEBOTS_CHIP_KIND(timer, board::timer::kRegisters,
                 [](const BoardDevice& /*entry*/, ChipHost& /*host*/) -> std::unique_ptr<Device> {
                   return std::make_unique<Timer>();
                 })
