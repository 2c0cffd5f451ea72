// SPDX-License-Identifier: Apache-2.0
#include "devices/core/kinds.hpp"
#include "mebots/soc/device.hpp"

namespace mebots::soc {
namespace {

/// Models the timer of machine mode: MTIME counts at 10 MHz, and the interrupt line is active while MTIME >= MTIMECMP.
/// Programs can write both registers. Registers of missing harts read 0. Source: RISC-V Advanced Core Local Interruptor
/// Specification 1.0-rc4, chapter "Machine-level timer device"; the second part of a SiFive CLINT, at offset 0x4000.
class Mtimer final : public Device {
 public:
  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override;
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override;
  bool load_is_quiet(std::uint32_t /*offset*/) const override { return true; }
  void advance(Picoseconds now) override { due_ = count_at(now) >= compare_; }
  Picoseconds next_event() const override;
  bool interrupt() const override { return due_; }
  void visit(state::Visitor& v) override {
    v("compare", compare_);
    v("written", written_);
    v("due", due_);
  }

 private:
  static constexpr std::uint32_t kCompare = 0x0000;
  static constexpr std::uint32_t kCompareHigh = 0x0004;
  static constexpr std::uint32_t kCount = 0x7ff8;
  static constexpr std::uint32_t kCountHigh = 0x7ffc;
  static constexpr Picoseconds kPeriod = 100 * kPsPerNs;

  std::uint64_t count_at(Picoseconds now) const { return static_cast<std::uint64_t>(now / kPeriod) + written_; }

  std::uint64_t compare_ = ~std::uint64_t{0};
  std::uint64_t written_ = 0;  // MTIME minus the ticks since reset
  bool due_ = false;
};

std::uint64_t with_low(std::uint64_t word, std::uint32_t low) {
  return (word & ~std::uint64_t{0xffffffffU}) | low;
}

std::uint64_t with_high(std::uint64_t word, std::uint32_t high) {
  return (word & 0xffffffffU) | std::uint64_t{high} << 32;
}

bool Mtimer::load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) {
  const auto word = offset < 8 ? compare_ : offset >= kCount ? count_at(now) : 0;
  value = static_cast<std::uint32_t>(offset % 8 == 0 ? word : word >> 32);
  return true;
}

bool Mtimer::store(std::uint32_t offset, Picoseconds now, std::uint32_t value) {
  const auto move_count = [&](std::uint64_t wanted) { written_ += wanted - count_at(now); };
  switch (offset) {
    case kCompare:
      compare_ = with_low(compare_, value);
      break;
    case kCompareHigh:
      compare_ = with_high(compare_, value);
      break;
    case kCount:
      move_count(with_low(count_at(now), value));
      break;
    case kCountHigh:
      move_count(with_high(count_at(now), value));
      break;
    default:
      return true;
  }
  due_ = count_at(now) >= compare_;
  return true;
}

/// Returns the time at which MTIME reaches MTIMECMP; kNever if that is beyond the simulation's range.
Picoseconds Mtimer::next_event() const {
  const auto tick = compare_ - written_;  // modulo 2^64
  if (due_ || tick > static_cast<std::uint64_t>(kNever / kPeriod)) return kNever;
  return static_cast<Picoseconds>(tick) * kPeriod;
}

}  // namespace
}  // namespace mebots::soc

MEBOTS_CHIP_KIND(aclint_mtimer, {}, [](const BoardDevice& /*entry*/, ChipHost& /*host*/) -> std::unique_ptr<Device> {
  return std::make_unique<Mtimer>();
})
