// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/renderer.hpp"
#include "dynamics/rigid_state.hpp"
#include "mebots/state/visitor.hpp"
#include "scene/scene.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace mebots::world {

/// Takes a picture when the count of requests changes. Two buffers: a picture's bytes stay in place while the
/// next one is taken, so a reader may hold them until the next step ends.
class CameraDevice {
 public:
  struct Settings {
    camera::Intrinsics intrinsics;
    camera::Mounting mounting;
    double noise_std = 0.0;  ///< grey levels of 255
    std::uint64_t seed = 0;  ///< until reseed()
  };

  CameraDevice(const scene::Scene& scene, const Settings& settings);

  /// Of the noise of pictures from now on. No part of the state: who holds the seed says it before every step.
  void reseed(std::uint64_t seed) { settings_.seed = seed; }

  /// Takes a picture from the body's pose at a time if `count` is new. A count of 0 asks for none.
  void see_trigger(std::int32_t count, const RigidState& body, std::int64_t time_ns);

  /// The last picture, row by row from the top left; empty before the first.
  std::span<const std::uint8_t> frame() const;
  /// The count that the last picture answers; 0 before the first.
  std::int32_t frame_id() const { return frame_id_; }

  void visit(state::Visitor& v);

 private:
  Settings settings_;
  camera::Renderer renderer_;
  std::array<std::vector<std::uint8_t>, 2> buffers_;
  std::uint8_t front_ = 0;
  std::int32_t last_count_ = 0;
  std::int32_t frame_id_ = 0;
};

}  // namespace mebots::world
