// SPDX-License-Identifier: Apache-2.0
#include "flight/ground_contact.hpp"

#include "mebots/assert.hpp"

namespace mebots::world {
namespace {

/// A drone leaves the ground if it rises this far above its first touch. The value is about the drone's width.
constexpr double kHop_m = 0.1;
/// A drone without a touch for longer than this is in the air, at any height.
constexpr std::int64_t kLongestHop_ns = 5'000'000'000;

}  // namespace

void GroundContact::update(bool touches, double height_m, std::int64_t time_ns) {
  MEBOTS_ASSERT(time_ns >= last_ns_);
  if (height_m > height_m_ + kHop_m || time_ns - last_ns_ > kLongestHop_ns) in_contact_ = false;
  if (!touches) return;
  if (!in_contact_) {
    in_contact_ = true;
    from_air_ = true;
    height_m_ = height_m;
    since_ns_ = time_ns;
  }
  last_ns_ = time_ns;
}

void GroundContact::visit(state::Visitor& v) {
  v("in_contact", in_contact_);
  v("from_air", from_air_);
  v("height_m", height_m_);
  v("since_ns", since_ns_);
  v("last_ns", last_ns_);
}

}  // namespace mebots::world
