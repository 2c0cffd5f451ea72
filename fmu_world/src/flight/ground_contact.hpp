// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"

#include <cstdint>

namespace mebots::world {

/// Tracks the drone's contact with surfaces below it. If the thrust is slightly less than the weight, a sinking drone
/// hops after its touch. Such hops are low, but take seconds. Hops of at most 10 cm and 5 s belong to the contact.
class GroundContact {
 public:
  /// A contact of at least `hold_ns` is a landing. If the drone starts on the ground, with its centre at
  /// `start_height_m`, the first contact is not a landing, because it did not begin in the air.
  GroundContact(bool starts_on_ground, double start_height_m, std::int64_t start_ns, std::int64_t hold_ns)
      : hold_ns_(hold_ns),
        in_contact_(starts_on_ground),
        height_m_(start_height_m),
        since_ns_(start_ns),
        last_ns_(start_ns) {}

  /// `touches` is true if the drone touches a surface below it. `height_m` is the height of the drone's centre. Times
  /// must not decrease.
  void update(bool touches, double height_m, std::int64_t time_ns);
  /// Call this function while the drone is at rest after its start or landing. The current contact then does not count
  /// as a landing.
  void stand() { from_air_ = false; }

  /// True if a contact that began in the air has lasted for the hold time.
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
