// SPDX-License-Identifier: Apache-2.0
#include "camera/sensor.hpp"

#include "camera/shading.hpp"
#include "mebots/assert.hpp"
#include "mebots/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace mebots::world::camera {
namespace {

/// Automatic exposure acts if mean and target differ by more than this number of grey levels. In the HM01B0 sensor,
/// this is the register CONVERGE_OUT_TH.
constexpr double kTolerance = 5.0;
constexpr double kMostChange = 2.0;
/// The least product of exposure and gain that automatic exposure sets, relative to the reference: an exposure of one
/// line if the reference is 340 lines.
constexpr double kLeastFactor = 1.0 / 340.0;

void require(bool good, const char* name, double value, const char* limit) {
  if (!good) throw Error(fmt::format("{} = {} must be {}", name, value, limit));
}

SensorSettings checked(const SensorSettings& s) {
  const auto at_least_zero = [](double value) { return value >= 0.0 && std::isfinite(value); };
  require(s.exposure_s >= 0.0 && s.exposure_s <= 1.0, "camera.exposure", s.exposure_s, "from 0 to 1 s");
  require(s.reference_exposure_s >= 0.0 && s.reference_exposure_s <= 1.0, "camera.reference_exposure",
          s.reference_exposure_s, "from 0 to 1 s");
  require(s.gain > 0.0 && s.gain <= 64.0, "camera.gain", s.gain, "more than 0 and at most 64");
  require(s.line_time_s >= 0.0 && s.line_time_s <= 1e-2, "camera.line_time", s.line_time_s, "from 0 to 0.01 s");
  require(s.blur_samples >= 1 && s.blur_samples <= 64, "camera.blur_samples", s.blur_samples, "from 1 to 64");
  require(at_least_zero(s.full_well), "camera.full_well", s.full_well, "a finite number >= 0");
  if (!s.automatic) return s;
  require(s.exposure_s > 0.0, "camera.exposure", s.exposure_s,
          "> 0 if camera.auto_exposure is on: the automatic exposure starts with this value");
  require(s.target > 0.0 && s.target < 255.0, "camera.auto_exposure_target", s.target, "more than 0 and less than 255");
  require(s.most_exposure_s >= s.exposure_s && s.most_exposure_s <= 1.0, "camera.auto_exposure_longest",
          s.most_exposure_s, "from camera.exposure to 1 s");
  require(s.most_gain >= 1.0 && s.most_gain <= 64.0, "camera.auto_gain_most", s.most_gain, "from 1 to 64");
  return s;
}

}  // namespace

Sensor::Sensor(std::shared_ptr<const Scenery> scenery, const Intrinsics& intrinsics, const LensSettings& lens,
               const SensorSettings& settings)
    : settings_(checked(settings)),
      intrinsics_(intrinsics),
      lens_(intrinsics, lens),
      renderer_(std::move(scenery), lens_.pinhole(), 0.0),
      workspace_(renderer_.make_workspace()),
      noise_(1.0),
      light_factor_(factor_of(settings.exposure_s, settings.gain)) {
  require(settings.noise_std >= 0.0 && std::isfinite(settings.noise_std), "camera.noise", settings.noise_std,
          "a finite number >= 0");
  const auto behind =
      static_cast<std::size_t>(lens_.pinhole().width) * static_cast<std::size_t>(lens_.pinhole().height);
  light_.resize(behind);
  once_.resize(behind);
  sensor_.resize(static_cast<std::size_t>(intrinsics.width) * static_cast<std::size_t>(intrinsics.height));
  row_noise_.resize(static_cast<std::size_t>(intrinsics.width));
}

double Sensor::factor_of(double exposure_s, double gain) const {
  const double reference_s =
      settings_.reference_exposure_s > 0.0 ? settings_.reference_exposure_s : settings_.exposure_s;
  return gain * (reference_s > 0.0 && exposure_s > 0.0 ? exposure_s / reference_s : 1.0);
}

/// With automatic exposure, returns the least power of two for which the exposure does not exceed its maximum. The
/// result is at most `most_gain`.
double Sensor::gain() const {
  if (!settings_.automatic) return settings_.gain;
  const double longest = factor_of(settings_.most_exposure_s, 1.0);
  double gain = 1.0;
  while (gain * 2.0 <= settings_.most_gain && light_factor_ > gain * longest) gain *= 2.0;
  return gain;
}

double Sensor::exposure_s() const {
  if (!settings_.automatic) return settings_.exposure_s;
  return std::min(settings_.most_exposure_s, light_factor_ / (gain() * factor_of(1.0, 1.0)));
}

void Sensor::gather_once(const PoseAt& pose_at, double after_s, std::span<float> light) {
  for_each_band(lens_.pinhole(), intrinsics_, settings_.line_time_s, [&](int first, int end, double later_s) {
    renderer_.render_light(pose_at(after_s + later_s), first, end, light, workspace_);
  });
}

void Sensor::gather(const PoseAt& pose_at) {
  const double exposure_s = this->exposure_s();
  const int samples = exposure_s > 0.0 ? settings_.blur_samples : 1;
  if (samples == 1) {
    gather_once(pose_at, 0.5 * exposure_s, light_);
    return;
  }
  std::fill(light_.begin(), light_.end(), 0.0F);
  for (int i = 0; i < samples; ++i) {
    gather_once(pose_at, exposure_s * (i + 0.5) / samples, once_);
    for (std::size_t k = 0; k < light_.size(); ++k) light_[k] += once_[k];
  }
  const float share = 1.0F / static_cast<float>(samples);
  for (float& light : light_) light *= share;
}

void Sensor::take(const PoseAt& pose_at, std::uint64_t seed, std::uint64_t frame_index,
                  std::span<std::uint8_t> pixels) {
  MEBOTS_ASSERT(pixels.size() == sensor_.size());
  gather(pose_at);
  lens_.project(light_, static_cast<float>(light_factor_), sensor_);
  // The noise at a grey level g has the variance reading + g shot. `shot` is the number of grey levels per electron,
  // which is proportional to the gain.
  const auto reading = static_cast<float>(settings_.noise_std * settings_.noise_std);
  const auto shot = static_cast<float>(settings_.full_well > 0.0 ? 255.0 * gain() / settings_.full_well : 0.0);
  const auto width = static_cast<std::size_t>(intrinsics_.width);
  for (int row = 0; row < intrinsics_.height; ++row) {
    const std::span<float> grey(sensor_.data() + static_cast<std::size_t>(row) * width, width);
    if (reading > 0.0F || shot > 0.0F) {
      std::fill(row_noise_.begin(), row_noise_.end(), 0.0F);
      noise_.add(row_noise_, seed, frame_index, row);
      for (std::size_t i = 0; i < width; ++i) grey[i] += row_noise_[i] * std::sqrt(reading + shot * grey[i]);
    }
    quantise(grey.data(), intrinsics_.width, pixels.data() + static_cast<std::size_t>(row) * width);
  }
  if (settings_.automatic) adjust(pixels);
}

void Sensor::adjust(std::span<const std::uint8_t> pixels) {
  const double mean = static_cast<double>(std::accumulate(pixels.begin(), pixels.end(), std::uint64_t{0})) /
                      static_cast<double>(pixels.size());
  if (std::abs(mean - settings_.target) <= kTolerance) return;
  const double change = std::clamp(settings_.target / std::max(mean, 1.0), 1.0 / kMostChange, kMostChange);
  const double most = factor_of(settings_.most_exposure_s, 1.0) * settings_.most_gain;
  light_factor_ = std::clamp(light_factor_ * change, kLeastFactor, most);
}

}  // namespace mebots::world::camera
