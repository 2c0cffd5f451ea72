// SPDX-License-Identifier: Apache-2.0
#include "devices/core/kinds.hpp"
#include "mebots/soc/device.hpp"

#include <array>
#include <bit>

namespace mebots::soc {
namespace {

/// Models a platform-level interrupt controller with one context: machine mode of the fabric controller. Sources are
/// level-triggered. The gateway of an active source forwards one request, and the next request only after the handler
/// has completed the first. Registers of other contexts and sources read 0. Source: RISC-V Platform-Level Interrupt
/// Controller Specification 1.0.0; number of sources and bits of a priority: QEMU 7.2, hw/riscv/virt.c.
class Plic final : public Device, public InterruptController {
 public:
  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override;
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override;
  bool load_is_quiet(std::uint32_t offset) const override { return offset != kClaim; }
  bool interrupt() const override { return best(threshold_) != 0; }
  unsigned last_source() const override { return kSources - 1; }
  void set_source(unsigned source, bool level) override;
  void visit(state::Visitor& v) override {
    v("priority", priority_);
    v("enabled", enabled_);
    v("up", up_);
    v("pending", pending_);
    v("in_service", in_service_);
    v("threshold", threshold_);
  }

 private:
  static constexpr unsigned kSources = 128;
  static constexpr std::uint32_t kPriorityMask = 7;
  static constexpr std::uint32_t kPending = 0x1000;
  static constexpr std::uint32_t kEnable = 0x2000;
  static constexpr std::uint32_t kThreshold = 0x20'0000;
  static constexpr std::uint32_t kClaim = 0x20'0004;

  using Words = std::array<std::uint32_t, kSources / 32>;

  static bool test(const Words& words, unsigned source) { return (words[source / 32] >> source % 32 & 1U) != 0; }
  static void set(Words& words, unsigned source, bool value) {
    const auto bit = 1U << source % 32;
    words[source / 32] = value ? words[source / 32] | bit : words[source / 32] & ~bit;
  }
  static std::uint32_t* word_at(Words& words, std::uint32_t first, std::uint32_t offset) {
    return offset >= first && offset - first < sizeof words ? &words[(offset - first) / 4] : nullptr;
  }
  unsigned best(std::uint32_t above) const;
  unsigned claim();
  void complete(std::uint32_t source);

  std::array<std::uint32_t, kSources> priority_{};
  Words enabled_{};
  Words up_{};          // level of each source
  Words pending_{};     // forwarded requests that no handler has claimed
  Words in_service_{};  // claimed and not completed
  std::uint32_t threshold_ = 0;
};

/// Returns the enabled and pending source with the highest priority above `above`, or 0 if no source qualifies. If
/// priorities are equal, the lowest source number wins.
unsigned Plic::best(std::uint32_t above) const {
  unsigned found = 0;
  for (unsigned word = 0; word < enabled_.size(); ++word) {
    for (auto ready = enabled_[word] & pending_[word]; ready != 0; ready &= ready - 1) {
      const auto source = 32 * word + static_cast<unsigned>(std::countr_zero(ready));
      if (priority_[source] <= above) continue;
      above = priority_[source];
      found = source;
    }
  }
  return found;
}

void Plic::set_source(unsigned source, bool level) {
  set(up_, source, level);
  if (level && !test(in_service_, source)) set(pending_, source, true);
}

/// The threshold does not apply to a claim.
unsigned Plic::claim() {
  const auto source = best(0);
  if (source == 0) return 0;
  set(pending_, source, false);
  set(in_service_, source, true);
  return source;
}

/// Ignores a source that is not enabled, as the specification requires.
void Plic::complete(std::uint32_t source) {
  if (source >= kSources || !test(enabled_, source) || !test(in_service_, source)) return;
  set(in_service_, source, false);
  set_source(source, test(up_, source));
}

bool Plic::load(std::uint32_t offset, Picoseconds /*now*/, std::uint32_t& value) {
  value = 0;
  if (offset < sizeof priority_) {
    value = priority_[offset / 4];
  } else if (const auto* pending = word_at(pending_, kPending, offset)) {
    value = *pending;
  } else if (const auto* enabled = word_at(enabled_, kEnable, offset)) {
    value = *enabled;
  } else if (offset == kThreshold) {
    value = threshold_;
  } else if (offset == kClaim) {
    value = claim();
  }
  return true;
}

bool Plic::store(std::uint32_t offset, Picoseconds /*now*/, std::uint32_t value) {
  if (offset < sizeof priority_) {
    if (offset != 0) priority_[offset / 4] = value & kPriorityMask;  // source 0 does not exist
  } else if (auto* enabled = word_at(enabled_, kEnable, offset)) {
    *enabled = offset == kEnable ? value & ~1U : value;
  } else if (offset == kThreshold) {
    threshold_ = value & kPriorityMask;
  } else if (offset == kClaim) {
    complete(value);
  }
  return true;
}

}  // namespace
}  // namespace mebots::soc

MEBOTS_CHIP_KIND(plic, {}, [](const BoardDevice& /*entry*/, ChipHost& /*host*/) -> std::unique_ptr<Device> {
  return std::make_unique<Plic>();
})
