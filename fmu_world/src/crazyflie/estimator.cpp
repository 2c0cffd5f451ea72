// SPDX-License-Identifier: Apache-2.0
#include "crazyflie/estimator.hpp"

namespace mebots::world::crazyflie {
namespace {

// Cut-off frequencies of the IMU's filters in crazyflie-firmware, src/hal/src/sensors_bmi088_bmp3xx.c.
constexpr double kRateCutoff_hz = 80.0;
constexpr double kForceCutoff_hz = 30.0;
constexpr double kImuRate_hz = 1e9 / static_cast<double>(Imu::kPeriod_ns);

double seconds(std::int64_t ns) {
  return 1e-9 * static_cast<double>(ns);
}

}  // namespace

Estimator::Estimator(const scene::FlowData& flow, const RigidState& start, std::int64_t start_ns)
    : filter_(flow, start),
      rate_filter_(kRateCutoff_hz, kImuRate_hz),
      force_filter_(kForceCutoff_hz, kImuRate_hz),
      state_(start),
      noise_ns_(start_ns),
      prediction_ns_(start_ns) {}

void Estimator::take_imu(std::int64_t time_ns, const Imu& imu) {
  if (imu.sample() == imu_sample_) return;
  imu_sample_ = imu.sample();
  rate_rad_per_s_ = rate_filter_(imu.rate_rad_per_s());
  rate_sum_ += rate_rad_per_s_;
  force_sum_ += force_filter_(imu.acceleration_m_per_s2());
  ++samples_;
  filter_.add_process_noise(seconds(time_ns - noise_ns_));
  noise_ns_ = time_ns;
}

bool Estimator::predict(std::int64_t time_ns, bool flying) {
  if (time_ns - prediction_ns_ < kPredictionPeriod_ns || samples_ == 0) return false;
  const auto count = static_cast<double>(samples_);
  filter_.predict(force_sum_ / count, rate_sum_ / count, flying, seconds(time_ns - prediction_ns_));
  prediction_ns_ = time_ns;
  rate_sum_.setZero();
  force_sum_.setZero();
  samples_ = 0;
  return true;
}

void Estimator::update(std::int64_t time_ns, const Imu& imu, const FlowSensor& flow, const RangeSensor& range,
                       bool flying) {
  take_imu(time_ns, imu);
  bool changed = predict(time_ns, flying);
  if (flow.sample().number != flow_sample_) {
    flow_sample_ = flow.sample().number;
    if (flow.sample().seen) {
      const double pixels = flow.data().resolution_pixels;
      filter_.measure_flow({pixels * flow.sample().counts[0], pixels * flow.sample().counts[1]}, rate_rad_per_s_,
                           flow.sample().period_s);
      changed = true;
    }
  }
  if (range.sample() != range_sample_) {
    range_sample_ = range.sample();
    if (range.reading_m() < range.limit_m()) {
      filter_.measure_distance(range.reading_m());
      changed = true;
    }
  }
  if (changed) {
    filter_.finish();
    state_.p_WB_m = filter_.position_m();
    state_.q_WB = filter_.attitude();
    state_.v_WB_m_per_s = filter_.velocity_W_m_per_s();
  }
  state_.w_WB_W_rad_per_s = state_.q_WB * rate_rad_per_s_;
}

void Estimator::visit(state::Visitor& v) {
  v("filter", filter_);
  v("rate_filter", rate_filter_);
  v("force_filter", force_filter_);
  v("state", state_);
  v("rate_rad_per_s", numbers(rate_rad_per_s_));
  v("rate_sum", numbers(rate_sum_));
  v("force_sum", numbers(force_sum_));
  v("samples", samples_);
  v("imu_sample", imu_sample_);
  v("flow_sample", flow_sample_);
  v("range_sample", range_sample_);
  v("noise_ns", noise_ns_);
  v("prediction_ns", prediction_ns_);
}

}  // namespace mebots::world::crazyflie
