// SPDX-License-Identifier: Apache-2.0
#include "positioning.hpp"

#include "draws.hpp"
#include "link_budget.hpp"

#include <cmath>

namespace mebots::radio {

Positioning::Positioning(const Parameters& parameters, std::span<NodeVariables> nodes, std::int64_t start_ns)
    : parameters_(parameters), variables_(nodes), start_ns_(start_ns) {}

void Positioning::step(const Span& span) {
  const double rate = parameters_.fix_rate_hz;
  if (rate <= 0) return;
  const auto due_ns = [&](std::int64_t number) { return start_ns_ + nanoseconds(static_cast<double>(number) / rate); };
  if (due_ns(next_) <= span.begin_ns) {
    sample(span.begin_ns);
    // Takes at most one sample per step, and skips the other samples.
    next_ = std::llround(std::floor(static_cast<double>(span.begin_ns - start_ns_) * 1e-9 * rate)) + 1;
    if (due_ns(next_) <= span.begin_ns) ++next_;
  }
  while (!under_way_.empty() && under_way_.front().there_ns <= span.end_ns) {
    const auto& fix = under_way_.front();
    auto& outputs = variables_[fix.node].outputs;
    outputs.fix_m = fix.position_m;
    ++outputs.fix_count;
    under_way_.erase(under_way_.begin());
  }
}

void Positioning::sample(std::int64_t time_ns) {
  const auto event = static_cast<std::uint64_t>(next_);
  for (std::size_t i = 0; i < variables_.size(); ++i) {
    if (uniform(parameters_.seed, {Purpose::fix_loss, i, 0, event}) < parameters_.fix_loss) continue;
    Fix fix{time_ns + nanoseconds(parameters_.fix_latency_s), i, variables_[i].inputs.position_m};
    for (std::size_t axis = 0; axis < fix.position_m.size(); ++axis) {
      fix.position_m[axis] +=
          parameters_.fix_noise_m * gaussian(parameters_.seed, {Purpose::fix_noise, i, axis, event});
    }
    under_way_.push_back(fix);
  }
}

void Positioning::Fix::visit(state::Visitor& v) {
  v("there_ns", there_ns);
  v("node", node);
  v("position_m", position_m);
}

void Positioning::visit(state::Visitor& v) {
  v("next", next_);
  v("under_way", under_way_);
}

}  // namespace mebots::radio
