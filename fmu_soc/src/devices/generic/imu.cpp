// SPDX-License-Identifier: Apache-2.0
#include "devices/core/active_time.hpp"
#include "devices/core/kinds.hpp"
#include "mebots/error.hpp"
#include "mebots/soc/device.hpp"
#include "mebots/soc/fixed_point.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace mebots::soc {
namespace {

constexpr std::size_t kAxes = 6;  // specific force x, y, z, then angular velocity x, y, z

/// Models an accelerometer and gyroscope with a FIFO.
///
/// A sample starts at each multiple of PERIOD. After the delay of the state `active`, the device reads its inputs, and
/// the sample enters the FIFO. Inputs are constant during a step. If the delay is shorter than the step, and the period
/// is a whole number of steps, the sample has the world's outputs at the start of the sample. Full scale: 24 g and 2000
/// degrees/s (Bosch, BMI088 data sheet).
class Imu final : public Device {
 public:
  Imu(const BoardDevice& entry, ChipHost& host)
      : entry_(entry), host_(host), active_time_(entry), delay_(std::llround(entry.state("active").delay_s * kPsPerS)) {
    for (std::size_t i = 0; i < kAxes; ++i) {
      if (const auto* variable = entry.variable(entry.name + kInputs[i])) inputs_[i] = variable->start;
    }
  }

  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override;
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override;
  void advance(Picoseconds now) override;
  Picoseconds next_event() const override { return active_time_.active() ? next_sample_ + delay_ : kNever; }
  bool interrupt() const override { return threshold_ != 0 && count_ >= threshold_; }
  double* input(std::string_view variable) override;
  void begin_step(Picoseconds now) override;
  double energy_j(Picoseconds now) const override { return active_time_.energy_j(now); }
  std::string_view state_name() const override { return active_time_.state_name(); }
  void visit(state::Visitor& v) override;

 private:
  static constexpr std::array<const char*, kAxes> kInputs{".acceleration.x",     ".acceleration.y",
                                                          ".acceleration.z",     ".angular_velocity.x",
                                                          ".angular_velocity.y", ".angular_velocity.z"};
  static constexpr std::uint32_t kControl = 0x00;
  static constexpr std::uint32_t kPeriod = 0x04;
  static constexpr std::uint32_t kThreshold = 0x08;
  static constexpr std::uint32_t kStatus = 0x0c;
  static constexpr std::uint32_t kTime = 0x10;
  static constexpr std::uint32_t kFirstAxis = 0x14;
  static constexpr std::uint32_t kNext = 0x2c;
  static constexpr std::uint32_t kLost = 1U << 8;
  static constexpr std::uint32_t kRefused = 1U << 9;
  static constexpr std::size_t kDepth = 32;
  static constexpr Picoseconds kPsPerUs = 1'000'000;
  /// After this number of steps with repeated samples, a warning is printed. A test program may hold its inputs for a
  /// few steps.
  static constexpr std::uint32_t kRepeatingSteps = 10;

  struct Sample {
    std::uint32_t time_us = 0;
    std::array<std::int16_t, kAxes> axes{};

    void visit(state::Visitor& v) {
      v("time_us", time_us);
      v("axes", axes);
    }
  };

  void switch_on(bool on, Picoseconds now);
  void plan(Picoseconds now) { next_sample_ = (now / period() + 1) * period(); }
  Picoseconds period() const { return period_us_ * kPsPerUs; }
  std::int16_t counts(std::size_t axis) const;
  void report_repeated_samples(Picoseconds step) const;

  const BoardDevice& entry_;
  DeviceHost& host_;
  ActiveTime active_time_;
  Picoseconds delay_;
  std::array<double, kAxes> inputs_{};
  std::array<Sample, kDepth> fifo_{};
  std::uint32_t first_ = 0;  // index of the oldest sample
  std::uint32_t count_ = 0;
  std::uint32_t period_us_ = 1000;
  std::uint32_t threshold_ = 1;
  std::uint32_t flags_ = 0;
  Picoseconds next_sample_ = 0;
  std::array<double, kAxes> last_inputs_{};  // inputs of the previous step
  Picoseconds step_began_ = 0;
  std::uint32_t samples_of_step_ = 0;
  std::uint32_t repeating_steps_ = 0;  // steps with several samples and changed inputs, up to kRepeatingSteps
};

double* Imu::input(std::string_view variable) {
  for (std::size_t i = 0; i < kAxes; ++i) {
    if (variable == entry_.name + kInputs[i]) return &inputs_[i];
  }
  return nullptr;
}

std::int16_t Imu::counts(std::size_t axis) const {
  constexpr double kStandardGravity = 9.80665;
  constexpr double kPerForce = 32768.0 / (24.0 * kStandardGravity);
  constexpr double kPerRate = 32768.0 / (2000.0 * std::numbers::pi / 180.0);
  const auto rounded = static_cast<std::int32_t>(to_register(inputs_[axis], axis < 3 ? kPerForce : kPerRate));
  return static_cast<std::int16_t>(std::clamp(rounded, -32768, 32767));
}

void Imu::begin_step(Picoseconds now) {
  const bool repeats = samples_of_step_ > 1 && inputs_ != last_inputs_;
  if (repeats && repeating_steps_ < kRepeatingSteps) {
    ++repeating_steps_;
    if (repeating_steps_ == kRepeatingSteps) report_repeated_samples(now - step_began_);
  }
  last_inputs_ = inputs_;
  step_began_ = now;
  samples_of_step_ = 0;
}

void Imu::report_repeated_samples(Picoseconds step) const {
  host_.complain(fmt::format(
      "the {0} samples of {1} within a communication step of {2} s have one value, because inputs change only at "
      "communication points. A control loop can fail with repeated samples. Set the config's \"step\" to the sample "
      "period, {3} s, or less",
      samples_of_step_, entry_.name, static_cast<double>(step) / kPsPerS, static_cast<double>(period()) / kPsPerS));
}

void Imu::switch_on(bool on, Picoseconds now) {
  if (!active_time_.set(on, now)) return;
  count_ = 0;
  plan(now);
}

void Imu::advance(Picoseconds now) {
  while (now >= next_event()) {
    ++samples_of_step_;
    if (count_ == kDepth) {
      flags_ |= kLost;
    } else {
      auto& sample = fifo_[(first_ + count_) % kDepth];
      sample.time_us = static_cast<std::uint32_t>(next_sample_ / kPsPerUs);
      for (std::size_t i = 0; i < kAxes; ++i) sample.axes[i] = counts(i);
      ++count_;
    }
    next_sample_ += period();
  }
}

bool Imu::load(std::uint32_t offset, Picoseconds /*now*/, std::uint32_t& value) {
  switch (offset) {
    case kControl:
      value = active_time_.active() ? 1 : 0;
      return true;
    case kPeriod:
      value = period_us_;
      return true;
    case kThreshold:
      value = threshold_;
      return true;
    case kStatus:
      value = count_ | flags_;
      return true;
    case kTime:
      value = count_ == 0 ? 0 : fifo_[first_].time_us;
      return true;
    default:
      break;
  }
  const auto axis = (offset - kFirstAxis) / 4;
  if (offset < kFirstAxis || axis >= kAxes) return false;
  value = count_ == 0 ? 0 : static_cast<std::uint32_t>(std::int32_t{fifo_[first_].axes[axis]});
  return true;
}

bool Imu::store(std::uint32_t offset, Picoseconds now, std::uint32_t value) {
  constexpr std::uint32_t kLeastPeriod_us = 500;
  constexpr std::uint32_t kMostPeriod_us = 65535;
  switch (offset) {
    case kControl:
      switch_on((value & 1) != 0, now);
      return true;
    case kPeriod:
      if (value < kLeastPeriod_us || value > kMostPeriod_us) {
        flags_ |= kRefused;
        return true;
      }
      period_us_ = value;
      plan(now);
      return true;
    case kThreshold:
      threshold_ = value;
      return true;
    case kStatus:
      flags_ &= ~value;
      return true;
    case kNext:
      if (count_ == 0) return true;
      first_ = (first_ + 1) % kDepth;
      --count_;
      return true;
    default:
      return false;
  }
}

void Imu::visit(state::Visitor& v) {
  v("inputs", inputs_);
  v("fifo", fifo_);
  v("first", first_);
  v("count", count_);
  v("period_us", period_us_);
  v("threshold", threshold_);
  v("flags", flags_);
  v("active_time", active_time_);
  v("next_sample", next_sample_);
  v("last_inputs", last_inputs_);
  v("step_began", step_began_);
  v("samples_of_step", samples_of_step_);
  v("repeating_steps", repeating_steps_);
  if (v.restores() && (first_ >= kDepth || count_ > kDepth || period_us_ == 0)) {
    throw Error(ErrorCode::state_damaged, "a saved state is damaged: the IMU's FIFO has more samples than places");
  }
}

}  // namespace
}  // namespace mebots::soc

MEBOTS_CHIP_KIND(imu, {}, make_of_entry<Imu>)
