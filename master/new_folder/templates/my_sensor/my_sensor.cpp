// SPDX-License-Identifier: Apache-2.0
// The sensor's behaviour, in C++ because states alone cannot say it: it resolves hundredths only. Registers, states,
// currents, delays and variables are those of board.json.
#include "mebots/soc/fixed_point.hpp"
#include "mebots/soc/own_device.hpp"

#include <cmath>
#include <memory>
#include <string>

namespace mebots::soc {
namespace {

class MySensor final : public OwnDevice {
 public:
  static constexpr std::uint32_t kCommand = 0x0;
  static constexpr std::uint32_t kStatus = 0x4;
  static constexpr std::uint32_t kValue = 0x8;
  static constexpr std::uint32_t kReport = 0xC;
  static constexpr std::uint32_t kStart = 1;
  static constexpr std::uint32_t kBusy = 1;
  static constexpr std::uint32_t kReady = 2;
  static constexpr std::uint32_t kRefused = 4;
  static constexpr double kResolution = 0.01;

  explicit MySensor(const BoardDevice& description) : description_(description) {}

  const BoardDevice& description() const override { return description_; }

  bool set_sensed(std::string_view variable, double value) override {
    if (variable != "my_sensor.value") return false;
    sensed_ = value;
    return true;
  }
  std::optional<double> sent(std::string_view variable) const override {
    if (variable == "my_sensor.reported") return from_register(report_, kMilli);
    return std::nullopt;
  }
  double energy_j(Picoseconds now) const override {
    const auto current_a = description_.state(std::string(state_name())).current_a;
    return energy_j_ + description_.supply_voltage_v * current_a * static_cast<double>(now - since_) / kPsPerS;
  }

  bool load(std::uint32_t offset, Picoseconds /*now*/, std::uint32_t& value) override {
    if (offset == kStatus) {
      value = status_;
    } else if (offset == kValue) {
      value = value_;
    } else if (offset == kReport) {
      value = report_;
    } else {
      return false;
    }
    return true;
  }
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override {
    if (offset == kCommand) {
      obey(value, now);
    } else if (offset == kStatus) {
      status_ &= ~(value & (kReady | kRefused));
    } else if (offset == kReport) {
      report_ = value;
    } else {
      return false;
    }
    return true;
  }

  /// The measurement is over.
  void advance(Picoseconds now) override {
    if (now < done_at_) return;
    value_ = to_register(std::round(sensed_ / kResolution) * kResolution, kMilli);
    change(now, kNever);
    status_ = (status_ & ~kBusy) | kReady;
  }
  Picoseconds next_event() const override { return done_at_; }
  bool interrupt() const override { return (status_ & kReady) != 0; }
  std::string_view state_name() const override { return (status_ & kBusy) != 0 ? "measuring" : "standby"; }

  void visit(state::Visitor& v) override {
    v("sensed", sensed_);
    v("energy_j", energy_j_);
    v("since", since_);
    v("done_at", done_at_);
    v("status", status_);
    v("value", value_);
    v("report", report_);
  }

 private:
  void obey(std::uint32_t command, Picoseconds now) {
    if (command != kStart || (status_ & kBusy) != 0) {
      status_ |= kRefused;
      return;
    }
    change(now, now + std::llround(description_.state("measuring").delay_s * kPsPerS));
    status_ |= kBusy;
  }
  /// Counts what the state up to now has drawn.
  void change(Picoseconds now, Picoseconds done_at) {
    energy_j_ = energy_j(now);
    since_ = now;
    done_at_ = done_at;
  }

  BoardDevice description_;
  double sensed_ = 0;
  double energy_j_ = 0;  // up to since_
  Picoseconds since_ = 0;
  Picoseconds done_at_ = kNever;
  std::uint32_t status_ = 0;
  std::uint32_t value_ = 0;
  std::uint32_t report_ = 0;
};

}  // namespace

std::unique_ptr<OwnDevice> make_own_device(const BoardDevice& entry) {
  return entry.name == "my_sensor" ? std::make_unique<MySensor>(entry) : nullptr;
}

}  // namespace mebots::soc
