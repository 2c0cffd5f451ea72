// SPDX-License-Identifier: Apache-2.0
#include "devices/core/kinds.hpp"
#include "mebots/error.hpp"
#include "mebots/soc/device.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

namespace mebots::soc {
namespace {

/// Models a timer with four PWM outputs. PERIOD and DUTY are buffered: new values take effect at the start of the next
/// period. If no new values wait for that start, next_event() returns kNever.
class Pwm final : public Device {
 public:
  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override;
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override;
  void advance(Picoseconds now) override {
    if (now >= next_period_) take(next_period_);
  }
  Picoseconds next_event() const override { return next_period_; }
  const double* output(std::string_view variable) const override;
  void program_ended() override { switch_off(); }
  void visit(state::Visitor& v) override;

 private:
  static constexpr std::size_t kOutputs = 4;
  static constexpr std::uint32_t kControl = 0x0;
  static constexpr std::uint32_t kPeriod = 0x4;
  static constexpr std::uint32_t kStatus = 0x8;
  static constexpr std::uint32_t kFirstDuty = 0xc;
  static constexpr std::uint32_t kMostTicks = 65536;
  static constexpr std::uint32_t kRefused = 1;
  static constexpr Picoseconds kTicksPerSecond = 84'000'000;

  /// Returns the length of a period, rounded up so that it is never 0.
  static Picoseconds length(std::uint32_t ticks) {
    return (ticks * Picoseconds{1'000'000'000'000} + kTicksPerSecond - 1) / kTicksPerSecond;
  }

  void switch_on(Picoseconds now);
  void switch_off();
  void take(Picoseconds now);
  void plan(Picoseconds now);
  /// Returns the stored value of the DUTY register at this offset, or null if there is no such register.
  std::uint32_t* duty_at(std::uint32_t offset);

  bool on_ = false;
  std::uint32_t status_ = 0;
  std::uint32_t stored_period_ = 256;
  std::array<std::uint32_t, kOutputs> stored_duty_{};
  std::uint32_t period_ = 256;    // length of the present period [ticks]
  Picoseconds period_since_ = 0;  // start of a period; all periods since then have the present length
  // Start of the first period with the stored values; kNever if there are no new values.
  Picoseconds next_period_ = kNever;
  std::array<double, kOutputs> command_{};
};

void Pwm::take(Picoseconds now) {
  period_ = stored_period_;
  period_since_ = now;
  next_period_ = kNever;
  for (std::size_t i = 0; i < kOutputs; ++i) {
    command_[i] = static_cast<double>(std::min(stored_duty_[i], period_)) / static_cast<double>(period_);
  }
}

void Pwm::plan(Picoseconds now) {
  if (!on_ || next_period_ != kNever) return;
  const auto length_ps = length(period_);
  next_period_ = period_since_ + ((now - period_since_) / length_ps + 1) * length_ps;
}

void Pwm::switch_on(Picoseconds now) {
  if (on_) return;
  on_ = true;
  take(now);
}

void Pwm::switch_off() {
  on_ = false;
  next_period_ = kNever;
  command_ = {};
}

std::uint32_t* Pwm::duty_at(std::uint32_t offset) {
  const auto index = (offset - kFirstDuty) / 4;
  return offset < kFirstDuty || index >= kOutputs ? nullptr : &stored_duty_[index];
}

bool Pwm::load(std::uint32_t offset, Picoseconds /*now*/, std::uint32_t& value) {
  switch (offset) {
    case kControl:
      value = on_ ? 1 : 0;
      return true;
    case kPeriod:
      value = stored_period_;
      return true;
    case kStatus:
      value = status_;
      return true;
    default:
      break;
  }
  const auto* duty = duty_at(offset);
  if (duty == nullptr) return false;
  value = *duty;
  return true;
}

bool Pwm::store(std::uint32_t offset, Picoseconds now, std::uint32_t value) {
  switch (offset) {
    case kControl:
      if ((value & 1) != 0) {
        switch_on(now);
      } else {
        switch_off();
      }
      return true;
    case kPeriod:
      if (value == 0 || value > kMostTicks) {
        status_ |= kRefused;
        return true;
      }
      stored_period_ = value;
      plan(now);
      return true;
    case kStatus:
      status_ &= ~value;
      return true;
    default:
      break;
  }
  auto* duty = duty_at(offset);
  if (duty == nullptr) return false;
  *duty = value;
  plan(now);
  return true;
}

const double* Pwm::output(std::string_view variable) const {
  for (std::size_t i = 0; i < kOutputs; ++i) {
    if (variable == fmt::format("rotor[{}].command", i + 1)) return &command_[i];
  }
  return nullptr;
}

void Pwm::visit(state::Visitor& v) {
  v("on", on_);
  v("status", status_);
  v("stored_period", stored_period_);
  v("stored_duty", stored_duty_);
  v("period", period_);
  v("period_since", period_since_);
  v("next_period", next_period_);
  v("command", command_);
  if (v.restores() && (stored_period_ == 0 || period_ == 0)) {
    throw Error(ErrorCode::state_damaged, "a saved state is damaged: a PWM output with a period of 0");
  }
}

}  // namespace
}  // namespace mebots::soc

MEBOTS_CHIP_KIND(pwm, {}, [](const BoardDevice& /*entry*/, ChipHost& /*host*/) -> std::unique_ptr<Device> {
  return std::make_unique<Pwm>();
})
