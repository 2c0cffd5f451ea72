// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"

#include <cstdint>

namespace mebots::world {

/// Tracks the drone's contact with surfaces below it. If the thrust is a little less than the weight, a sinking drone
/// hops after its touch. Such a hop is low, but takes seconds. Hops of at most 10 cm and 5 s belong to the contact.
class GroundContact {
 public:
  /// Creates the tracker. A contact that lasts for `hold_ns` is a landing. If the drone starts on the ground, with its
  /// centre at `start_height_m`, its first contact did not begin in the air, and is no landing.
  GroundContact(bool starts_on_ground, double start_height_m, std::int64_t start_ns, std::int64_t hold_ns)
      : hold_ns_(hold_ns),
        in_contact_(starts_on_ground),
        height_m_(start_height_m),
        since_ns_(start_ns),
        last_ns_(start_ns) {}

  /// Updates the contact. `touches` states whether the drone touches a surface below it, and `height_m` is the height
  /// of its centre. Times must not decrease.
  void update(bool touches, double height_m, std::int64_t time_ns);
  /// Reports that the drone is at rest where it started or landed. This contact does not count as a landing.
  void stand() { from_air_ = false; }

  /// Returns true if a contact that began in the air has lasted for the hold time.
  bool has_landed() const { return in_contact_ && from_air_ && last_ns_ - since_ns_ >= hold_ns_; }
  /// Returns the time of the first touch of the current contact.
  std::int64_t since_ns() const { return since_ns_; }

  void visit(state::Visitor& v);

 private:
  std::int64_t hold_ns_;
  bool in_contact_;
  bool from_air_ = false;
  double height_m_;  // height at the first touch
  std::int64_t since_ns_;
  std::int64_t last_ns_;
};

}  // namespace mebots::world
