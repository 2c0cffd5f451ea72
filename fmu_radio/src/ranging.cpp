// SPDX-License-Identifier: Apache-2.0
#include "ranging.hpp"

#include "draws.hpp"
#include "link_budget.hpp"
#include "mebots/error.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace mebots::radio {
namespace {

constexpr int kMessages = 4;
constexpr int kSentByEach = kMessages / 2;

std::int64_t exchange_ns(const Parameters& parameters) {
  return nanoseconds(kMessages * parameters.ranging_message_time_s + (kMessages - 1) * parameters.ranging_reply_time_s);
}

}  // namespace

Ranging::Ranging(const Parameters& parameters, std::span<NodeVariables> nodes)
    : parameters_(parameters), variables_(nodes), requests_(nodes.size(), 0) {
  for (const auto& node : nodes) counts_.push_back(node.inputs.ranging_count);
}

void Ranging::step(const Span& span) {
  ended_.clear();
  for (std::size_t i = 0; i < counts_.size(); ++i) take_request(i, span.begin_ns);
  while (!exchanges_.empty() && exchanges_.front().end_ns <= span.end_ns) {
    finish(exchanges_.front());
    ended_.push_back(exchanges_.front());
    exchanges_.erase(exchanges_.begin());
  }
}

void Ranging::take_request(std::size_t node, std::int64_t time_ns) {
  const auto& inputs = variables_[node].inputs;
  if (inputs.ranging_count == counts_[node]) return;
  counts_[node] = inputs.ranging_count;
  ++requests_[node];  // counts refused requests too, so that they do not change the random numbers of later requests
  const auto number = static_cast<std::int32_t>(node) + 1;
  const auto most = static_cast<std::int32_t>(counts_.size());
  if (inputs.ranging_to < 1 || inputs.ranging_to > most || inputs.ranging_to == number)
    throw Error(
        fmt::format("node[{}].ranging.to = {} must be another node from 1 to {}", number, inputs.ranging_to, most));
  if (std::ranges::find(exchanges_, number, &Exchange::from) != exchanges_.end()) {
    ++variables_[node].outputs.ranging_failed;
    return;
  }
  const auto begin = std::max(free_ns_, time_ns);
  free_ns_ = begin + exchange_ns(parameters_);
  exchanges_.push_back({begin, free_ns_, number, inputs.ranging_to, requests_[node]});
}

void Ranging::finish(const Exchange& exchange) {
  const auto from = static_cast<std::size_t>(exchange.from) - 1;
  const auto to = static_cast<std::size_t>(exchange.to) - 1;
  const auto event = static_cast<std::uint64_t>(exchange.number);
  auto& outputs = variables_[from].outputs;
  const double distance = distance_m(variables_[from], variables_[to]);
  if (distance > parameters_.ranging_range_m ||
      uniform(parameters_.seed, {Purpose::ranging_loss, from, to, event}) < parameters_.ranging_loss) {
    ++outputs.ranging_failed;
    return;
  }
  const double noise =
      parameters_.ranging_noise_m * gaussian(parameters_.seed, {Purpose::ranging_noise, from, to, event});
  outputs.ranging_distance_m = std::max(0.0, distance + parameters_.ranging_bias_m + noise);
  outputs.ranging_from = exchange.to;
  ++outputs.ranging_done;
}

double Ranging::energy_j(std::size_t node, const Span& span) const {
  const auto number = static_cast<std::int32_t>(node) + 1;
  const double sending_share =
      kSentByEach * parameters_.ranging_message_time_s * 1e9 / static_cast<double>(exchange_ns(parameters_));
  const double mean_current_a = sending_share * parameters_.ranging_transmit_current_a +
                                (1 - sending_share) * parameters_.ranging_receive_current_a;
  std::int64_t busy_ns = 0;
  for (const auto* exchanges : {&exchanges_, &ended_}) {
    for (const auto& one : *exchanges) {
      if (one.from == number || one.to == number) busy_ns += overlap_ns(span, one.begin_ns, one.end_ns);
    }
  }
  const auto idle_ns = span.end_ns - span.begin_ns - busy_ns;
  return parameters_.ranging_voltage_v * 1e-9 *
         (mean_current_a * static_cast<double>(busy_ns) +
          parameters_.ranging_idle_current_a * static_cast<double>(idle_ns));
}

void Ranging::Exchange::visit(state::Visitor& v) {
  v("begin_ns", begin_ns);
  v("end_ns", end_ns);
  v("from", from);
  v("to", to);
  v("number", number);
}

void Ranging::visit(state::Visitor& v) {
  v("counts", counts_);
  v("requests", requests_);
  v("exchanges", exchanges_);
  v("free_ns", free_ns_);
  if (v.restores()) ended_.clear();
}

}  // namespace mebots::radio
