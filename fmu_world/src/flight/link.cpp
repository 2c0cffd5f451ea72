// SPDX-License-Identifier: Apache-2.0
#include "flight/link.hpp"

#include <algorithm>

namespace mebots::world {

const Setpoint& Link::exchange(const Setpoint& sent, std::int64_t time_ns) {
  if (latency_ns_ == 0) return arrived_ = sent;
  const Setpoint& last = under_way_.empty() ? arrived_ : under_way_.back().setpoint;
  if (!(sent == last)) under_way_.push_back({time_ns, time_ns + latency_ns_, sent});
  const auto later = std::find_if(under_way_.begin(), under_way_.end(),
                                  [time_ns](const Message& message) { return message.due_ns > time_ns; });
  if (later != under_way_.begin()) {
    arrived_ = (later - 1)->setpoint;
    travelled_ns_ = time_ns - (later - 1)->sent_ns;
    under_way_.erase(under_way_.begin(), later);
  }
  return arrived_;
}

void Link::visit(state::Visitor& v) {
  v("arrived", arrived_);
  v("travelled_ns", travelled_ns_);
  v("under_way", under_way_);
}

}  // namespace mebots::world
