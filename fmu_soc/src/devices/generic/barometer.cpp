// SPDX-License-Identifier: Apache-2.0
#include "devices/core/active_time.hpp"
#include "devices/core/kinds.hpp"
#include "devices/generic/random_numbers.hpp"
#include "mebots/error.hpp"
#include "mebots/soc/device.hpp"
#include "mebots/soc/fixed_point.hpp"

#include <fmt/core.h>

#include <cmath>
#include <cstdint>

namespace mebots::soc {
namespace {

/// Returns the pressure of the standard atmosphere below 11 km [Pa]: 101325 (1 - 0.0065 h / 288.15)^5.25588 (ISO 2533).
/// A binomial series in place of std::pow gives the same bits with every mathematical library.
double standard_pressure_pa(double altitude_m) {
  constexpr double kExponent = 5.25588;
  const double x = -0.0065 * altitude_m / 288.15;
  double term = 1.0;
  double sum = 1.0;
  for (int n = 1; n <= 24; ++n) {
    term *= x * (kExponent - (n - 1)) / n;
    sum += term;
  }
  return 101325.0 * sum;
}

/// Returns a random number with mean 0 and variance 1: the sum of twelve uniform numbers minus 6.
double normal(std::uint64_t seed, std::uint64_t index) {
  constexpr unsigned kNumbers = 12;
  auto state = random_state(seed, index, kNumbers);
  double sum = -6.0;
  for (unsigned i = 0; i < kNumbers; ++i, state += kSplitMixStep) sum += uniform_number(state);
  return sum;
}

/// Returns the time of a measurement, which is the delay of the state `active`. Throws Error if the delay is below 1
/// us, because with a delay of 0, the barometer would measure without end at one time.
Picoseconds measurement_time(const BoardDevice& entry) {
  constexpr double kLeastS = 1e-6;
  const auto delay_s = entry.state("active").delay_s;
  if (delay_s >= kLeastS) return std::llround(delay_s * kPsPerS);
  throw Error(
      ErrorCode::value_out_of_range,
      fmt::format("board: device {}: the delay {} s of its state 'active' must be at least {} s: it is the time of a "
                  "measurement",
                  entry.name, delay_s, kLeastS));
}

/// Models a barometer that measures without pause while it is on. Each measurement takes the delay of the state
/// `active`.
class Barometer final : public Device {
 public:
  Barometer(const BoardDevice& entry, ChipHost& /*host*/)
      : entry_(entry), active_time_(entry), delay_(measurement_time(entry)) {
    for (const auto& variable : entry.variables) {
      if (auto* number = input(variable.name)) *number = variable.start;
    }
  }

  bool load(std::uint32_t offset, Picoseconds /*now*/, std::uint32_t& value) override {
    const std::uint32_t values[] = {active_time_.active() ? 1U : 0U, status_, pressure_};
    if (offset > kPressure) return false;
    value = values[offset / 4];
    return true;
  }
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override {
    if (offset == kStatus) {
      status_ &= ~value;
      return true;
    }
    if (offset != kControl) return false;
    const bool on = (value & 1) != 0;
    if (active_time_.set(on, now)) next_ = on ? now + delay_ : kNever;
    return true;
  }
  void advance(Picoseconds now) override {
    while (now >= next_) {
      const double noise_pa =
          noise_pa_ * normal(static_cast<std::uint32_t>(static_cast<std::int32_t>(seed_)), count_++);
      pressure_ = to_register(standard_pressure_pa(ground_m_ + altitude_m_) + noise_pa, kPerPascal);
      status_ |= 1;
      next_ += delay_;
    }
  }
  Picoseconds next_event() const override { return next_; }
  double* input(std::string_view variable) override {
    if (variable == entry_.name + ".altitude") return &altitude_m_;
    if (variable == entry_.name + ".ground_altitude") return &ground_m_;
    if (variable == entry_.name + ".noise") return &noise_pa_;
    if (variable == entry_.name + ".seed") return &seed_;
    return nullptr;
  }
  double energy_j(Picoseconds now) const override { return active_time_.energy_j(now); }
  std::string_view state_name() const override { return active_time_.state_name(); }
  void visit(state::Visitor& v) override {
    v("altitude_m", altitude_m_);
    v("ground_m", ground_m_);
    v("noise_pa", noise_pa_);
    v("seed", seed_);
    v("active_time", active_time_);
    v("status", status_);
    v("pressure", pressure_);
    v("count", count_);
    v("next", next_);
  }

 private:
  static constexpr std::uint32_t kControl = 0x0;
  static constexpr std::uint32_t kStatus = 0x4;
  static constexpr std::uint32_t kPressure = 0x8;
  static constexpr double kPerPascal = 100;

  const BoardDevice& entry_;
  ActiveTime active_time_;
  Picoseconds delay_;
  double altitude_m_ = 0;
  double ground_m_ = 0;
  double noise_pa_ = 0;
  double seed_ = 0;
  std::uint32_t status_ = 0;
  std::uint32_t pressure_ = 0;
  std::uint64_t count_ = 0;  // number of measurements since reset
  Picoseconds next_ = kNever;
};

}  // namespace
}  // namespace mebots::soc

MEBOTS_CHIP_KIND(barometer, {}, make_of_entry<Barometer>)
