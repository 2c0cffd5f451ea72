// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/lens.hpp"
#include "camera/pixel_noise.hpp"
#include "camera/renderer.hpp"
#include "mebots/state/visitor.hpp"

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace mebots::world::camera {

/// How the sensor takes its light. All zero and a gain of 1: a sensor that sees a whole picture in an instant, as the
/// renderer makes it.
struct SensorSettings {
  double exposure_s = 0.0;  ///< that each row gathers light; 0 = an instant
  double reference_exposure_s =
      0.0;                       ///< at which, with a gain of 1, the scene's grey levels are seen; 0 = `exposure_s`
  double gain = 1.0;             ///< > 0
  bool automatic = false;        ///< exposure and gain follow the picture's mean
  double target = 60.0;          ///< that the mean is to have, grey level
  double most_exposure_s = 0.0;  ///< that automatic exposure may choose
  double most_gain = 8.0;        ///< the same of the gain, which it takes from 1, 2, 4, 8, ...
  double line_time_s = 0.0;      ///< from one row's beginning to the next one's; 0 = all at once
  int blur_samples = 8;          ///< pictures that make a blurred one, 1..64; 1 = no motion blur
  double full_well = 0.0;        ///< electrons that grey level 255 stands for at a gain of 1; 0 = no shot noise
  double noise_std = 0.0;        ///< what reading adds, grey levels

  bool is_neutral() const {
    return exposure_s == 0.0 && gain == 1.0 && !automatic && line_time_s == 0.0 && full_well == 0.0;
  }
};

/// A camera's lens and sensor before a scene: picture = rounded (noise + light on the sensor x exposure x gain).
///
/// Row r gathers light from t + r line_time on, for the exposure, while the camera goes on as it did at t. The renderer
/// takes bands of eight rows at one time each, and `blur_samples` pictures for the exposure. Rows count in the picture
/// before distortion. Shot noise: n electrons vary by sqrt(n). Automatic exposure looks at a picture's mean when it is
/// done. If that is further than 5 grey levels from the target, the product of exposure and gain is multiplied by
/// target / mean, at most by 2 and at least by 1/2. The exposure is lengthened first, then the gain is doubled.
class Sensor {
 public:
  /// The camera's pose some seconds after the picture begins.
  using PoseAt = std::function<Pose(double after_s)>;

  /// Throws mebots::Error naming a parameter whose value makes no camera.
  Sensor(const scene::Scene& scene, const Intrinsics& intrinsics, const LensSettings& lens,
         const SensorSettings& settings);

  /// Takes a picture; the noise is a function of seed, index, row and column. Needs no heap.
  void take(const PoseAt& pose_at, std::uint64_t seed, std::uint64_t frame_index, std::span<std::uint8_t> pixels);

  /// Of the next picture.
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
  std::vector<float> light_;   // the pinhole's picture
  std::vector<float> once_;    // one of those that make a blurred one
  std::vector<float> sensor_;  // behind the lens
  std::vector<float> row_noise_;
  double light_factor_;  // exposure x gain over reference exposure: the whole memory of automatic exposure
};

}  // namespace mebots::world::camera
