// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmu_world/variables.hpp"
#include "mebots/state/visitor.hpp"

#include <cstdint>
#include <vector>

namespace mebots::world {

struct Setpoint {
  FlightMode mode = FlightMode::off;
  double forward_m_per_s = 0.0;
  double left_m_per_s = 0.0;
  double yaw_rate_rad_per_s = 0.0;
  double altitude_m = 0.0;

  bool operator==(const Setpoint&) const = default;
  void visit(state::Visitor& v) {
    v("mode", mode);
    v("forward_m_per_s", forward_m_per_s);
    v("left_m_per_s", left_m_per_s);
    v("yaw_rate_rad_per_s", yaw_rate_rad_per_s);
    v("altitude_m", altitude_m);
  }
};

/// Delays the set-points for the stabiliser. A set-point arrives `latency` after it was sent. Set-points keep their
/// order. Before the first set-point arrives, the mode is `off`.
class Link {
 public:
  explicit Link(std::int64_t latency_ns) : latency_ns_(latency_ns) {}

  /// Sends a set-point at a time, which must not be before the time of the previous call. Returns the last set-point
  /// that has arrived.
  const Setpoint& exchange(const Setpoint& sent, std::int64_t time_ns);
  /// Returns the time from the sending to the arrival of the last set-point that arrived; 0 before the first arrival.
  std::int64_t travelled_ns() const { return travelled_ns_; }

  void visit(state::Visitor& v);

 private:
  struct Message {
    std::int64_t sent_ns = 0;
    std::int64_t due_ns = 0;
    Setpoint setpoint;

    void visit(state::Visitor& v) {
      v("sent_ns", sent_ns);
      v("due_ns", due_ns);
      v("setpoint", setpoint);
    }
  };

  std::int64_t latency_ns_;
  Setpoint arrived_;
  std::int64_t travelled_ns_ = 0;
  std::vector<Message> under_way_;
};

}  // namespace mebots::world
