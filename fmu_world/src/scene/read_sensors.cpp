// SPDX-License-Identifier: Apache-2.0
#include "scene/read_sensors.hpp"

#include "mebots/data/object.hpp"
#include "scene/vector_reader.hpp"

#include <fmt/format.h>
#include <cstdint>
#include <limits>

namespace mebots::world::scene {

using data::Limits;
using data::Node;
using data::Object;
using data::quantity;

namespace {

/// Permitted periods of a sensor [s].
const Limits kPeriods = Limits::between(0.001, 10.0);

constexpr double kFinestFlow_pixels = 1e-3;

/// Returns an upper bound of the counts in a sample.
double most_counts(const FlowData& flow) {
  constexpr double kLongestStep_s = 1.0;  // largest physics step, by which a sample may be late
  constexpr double kLargestDeviation = 10.0;
  return (flow.pixels_per_rad * flow.fastest_rad_per_s * (flow.period_s + kLongestStep_s) +
          kLargestDeviation * flow.noise_pixels) /
         flow.resolution_pixels;
}

}  // namespace

RangeData read_range(const Node& node) {
  const auto positive = Limits::positive();
  Object object(node);
  RangeData range;
  object.read("field_of_view", range.field_of_view_rad, quantity("rad", Limits::between(0.0, 1.5)));
  object.read("period", range.period_s, quantity("s", kPeriods));
  object.read("resolution", range.resolution_m, quantity("m", Limits::at_least(0.0)));
  object.read("near", range.near_m, quantity("m", Limits::at_least(0.0)));
  object.read("near_noise", range.near_noise_m, quantity("m", positive));
  object.read("far", range.far_m, quantity("m", positive));
  object.read("far_noise", range.far_noise_m, quantity("m", positive));
  object.finish();
  if (object.sound() && range.far_m <= range.near_m) {
    node.at("far").complain(ErrorCode::invalid_value,
                            fmt::format("{} m must be greater than near, {} m", range.far_m, range.near_m));
  }
  return range;
}

FlowData read_flow(const Node& node) {
  const auto positive = Limits::positive();
  Object object(node);
  FlowData flow;
  object.read("pixels_per_rad", flow.pixels_per_rad, quantity("1/rad", positive));
  object.read("period", flow.period_s, quantity("s", kPeriods));
  object.read("resolution", flow.resolution_pixels, quantity("1", Limits::at_least(kFinestFlow_pixels)));
  object.read("noise", flow.noise_pixels, quantity("1", Limits::at_least(0.0)));
  object.read("nearest", flow.nearest_m, quantity("m", Limits::at_least(0.0)));
  object.read("fastest", flow.fastest_rad_per_s, quantity("rad/s", positive));
  object.finish();
  if (object.sound() && most_counts(flow) > std::numeric_limits<std::int32_t>::max()) {
    node.at("resolution")
        .complain(
            ErrorCode::invalid_value,
            fmt::format("a sample could have {:.3g} counts, more than 32 bits can hold: use a coarser resolution, or "
                        "reduce pixels_per_rad, fastest, noise or period",
                        most_counts(flow)));
  }
  return flow;
}

MultirangerData read_multiranger(const Node& node) {
  Object object(node);
  MultirangerData multiranger;
  object.read("offset", multiranger.offset_m, sourced_vector("m", Limits::at_least(0.0)));
  object.read("period", multiranger.period_s, quantity("s", kPeriods));
  object.read("power", multiranger.power_w, quantity("W", Limits::at_least(0.0)));
  object.finish();
  return multiranger;
}

BarometerData read_barometer(const Node& node) {
  const auto at_least_zero = Limits::at_least(0.0);
  Object object(node);
  BarometerData barometer;
  object.read("period", barometer.period_s, quantity("s", kPeriods));
  object.read("resolution", barometer.resolution_pa, quantity("Pa", at_least_zero));
  object.read("noise", barometer.noise_pa, quantity("Pa", at_least_zero));
  object.read("bias", barometer.bias_pa, quantity("Pa", at_least_zero));
  object.read("power", barometer.power_w, quantity("W", at_least_zero));
  object.finish();
  return barometer;
}

MagnetometerData read_magnetometer(const Node& node) {
  const auto at_least_zero = Limits::at_least(0.0);
  Object object(node);
  MagnetometerData magnetometer;
  object.read("period", magnetometer.period_s, quantity("s", kPeriods));
  object.read("limit", magnetometer.limit_t, quantity("T", Limits::positive()));
  object.read("resolution", magnetometer.resolution_t, quantity("T", at_least_zero));
  object.read("noise", magnetometer.noise_t, sourced_vector("T", at_least_zero));
  object.read("bias", magnetometer.bias_t, quantity("T", at_least_zero));
  object.read("power", magnetometer.power_w, quantity("W", at_least_zero));
  object.finish();
  return magnetometer;
}

}  // namespace mebots::world::scene
