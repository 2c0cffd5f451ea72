// SPDX-License-Identifier: Apache-2.0
// The behaviour of the sensor. It is in C++, because states alone cannot describe it: the sensor has a resolution of
// hundredths. Registers, states, currents, delays and variables are in board.json. That file also names the kind and
// the library that are built from this file.
#include "mebots/soc/device_kind.hpp"
#include "mebots/soc/fixed_point.hpp"

#include <cmath>
#include <memory>
#include <string_view>

namespace {

using namespace mebots::soc;

class MySensor final : public Device {
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

  explicit MySensor(const BoardDevice& entry) : entry_(entry) {}

  double* input(std::string_view variable) override { return variable == "my_sensor.value" ? &sensed_ : nullptr; }
  const double* output(std::string_view variable) const override {
    return variable == "my_sensor.reported" ? &reported_ : nullptr;
  }
  double energy_j(Picoseconds now) const override {
    const auto current_a = entry_.state(state_name()).current_a;
    return energy_j_ + entry_.supply_voltage_v * current_a * static_cast<double>(now - since_) / kPsPerS;
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
      reported_ = from_register(value, kMilli);
    } else {
      return false;
    }
    return true;
  }

  /// Ends the measurement.
  void advance(Picoseconds now) override {
    if (now < done_at_) return;
    value_ = to_register(std::round(sensed_ / kResolution) * kResolution, kMilli);
    change(now, kNever);
    status_ = (status_ & ~kBusy) | kReady;
  }
  Picoseconds next_event() const override { return done_at_; }
  bool interrupt() const override { return (status_ & kReady) != 0; }
  std::string_view state_name() const override { return (status_ & kBusy) != 0 ? "measuring" : "standby"; }

  void visit(mebots::state::Visitor& v) override {
    v("sensed", sensed_);
    v("reported", reported_);
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
    change(now, now + std::llround(entry_.state("measuring").delay_s * kPsPerS));
    status_ |= kBusy;
  }
  /// Adds the energy used in the present state until now.
  void change(Picoseconds now, Picoseconds done_at) {
    energy_j_ = energy_j(now);
    since_ = now;
    done_at_ = done_at;
  }

  const BoardDevice& entry_;
  double sensed_ = 0;
  double reported_ = 0;
  double energy_j_ = 0;  // up to since_
  Picoseconds since_ = 0;
  Picoseconds done_at_ = kNever;
  std::uint32_t status_ = 0;
  std::uint32_t value_ = 0;
  std::uint32_t report_ = 0;
};

std::unique_ptr<Device> make(const BoardDevice& entry, DeviceHost& /*host*/) {
  return std::make_unique<MySensor>(entry);
}

}  // namespace

MEBOTS_DEVICE_KINDS({"my_sensor", make})
