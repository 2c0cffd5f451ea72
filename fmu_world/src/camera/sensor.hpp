// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/bands.hpp"
#include "camera/lens.hpp"
#include "camera/pixel_noise.hpp"
#include "camera/renderer.hpp"
#include "mebots/state/visitor.hpp"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace mebots::world::camera {

/// Settings of the sensor. If all are zero and the gain is 1, the sensor exposes the whole picture at one instant, as
/// the renderer does.
struct SensorSettings {
  double exposure_s = 0.0;            ///< exposure of each row; 0 = an instant
  double reference_exposure_s = 0.0;  ///< exposure that gives the scene's grey levels at a gain of 1; 0 = `exposure_s`
  double gain = 1.0;                  ///< > 0
  bool automatic = false;             ///< exposure and gain follow the picture's mean
  double target = 60.0;               ///< wanted mean grey level
  double most_exposure_s = 0.0;       ///< maximum of automatic exposure
  double most_gain = 8.0;             ///< maximum gain; automatic exposure uses 1, 2, 4, 8, ...
  double line_time_s = 0.0;           ///< from the start of one row to the start of the next; 0 = all rows at once
  int blur_samples = 8;               ///< renderings per blurred picture, 1..64; 1 = no motion blur
  double full_well = 0.0;             ///< electrons at grey level 255 with a gain of 1; 0 = no shot noise
  double noise_std = 0.0;             ///< read noise, in grey levels

  bool is_neutral() const {
    return exposure_s == 0.0 && gain == 1.0 && !automatic && line_time_s == 0.0 && full_well == 0.0;
  }
};

/// A camera's lens and sensor: picture = rounded (noise + light on the sensor x exposure x gain).
///
/// The exposure of row r starts at t + r line_time. Until the end of the last exposure, the camera continues the motion
/// that it has at t. All eight rows of a band of the undistorted picture have the same time. With an exposure above 0,
/// the light of a pixel is the mean of `blur_samples` renderings at times within its exposure. Shot noise: the standard
/// deviation of n electrons is sqrt(n).
///
/// Automatic exposure corrects the next picture if a picture's mean differs from the target by more than 5 grey levels.
/// It multiplies the product of exposure and gain by target / mean, limited to 1/2 to 2. It increases the exposure
/// first, then doubles the gain.
class Sensor {
 public:
  /// Throws mebots::Error that names a parameter with an invalid value.
  Sensor(std::shared_ptr<const Scenery> scenery, const Intrinsics& intrinsics, const LensSettings& lens,
         const SensorSettings& settings);
  Sensor(const scene::Scene& scene, const Intrinsics& intrinsics, const LensSettings& lens,
         const SensorSettings& settings)
      : Sensor(std::make_shared<const Scenery>(make_geometry(scene)), intrinsics, lens, settings) {}

  /// Takes a picture. The noise depends only on seed, index, row and column. Uses no heap.
  void take(const PoseAt& pose_at, std::uint64_t seed, std::uint64_t frame_index, std::span<std::uint8_t> pixels);

  /// The exposure and the gain of the next picture.
  double exposure_s() const;
  double gain() const;

  void visit(state::Visitor& v) { v("light_factor", light_factor_); }

 private:
  double factor_of(double exposure_s, double gain) const;
  void gather(const PoseAt& pose_at);
  void gather_once(const PoseAt& pose_at, double after_s, std::span<float> light);
  void adjust(std::span<const std::uint8_t> pixels);

  SensorSettings settings_;
  Intrinsics intrinsics_;
  Lens lens_;
  Renderer renderer_;
  Renderer::Workspace workspace_;
  PixelNoise noise_;
  std::vector<float> light_;   // of the pinhole's picture
  std::vector<float> once_;    // one rendering of a blurred picture
  std::vector<float> sensor_;  // after the lens
  std::vector<float> row_noise_;
  double light_factor_;  // exposure x gain over reference exposure: the only state of automatic exposure
};

}  // namespace mebots::world::camera
