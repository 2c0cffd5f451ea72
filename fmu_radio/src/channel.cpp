// SPDX-License-Identifier: Apache-2.0
#include "channel.hpp"

#include "draws.hpp"
#include "link_budget.hpp"
#include "mebots/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace mebots::radio {
namespace {

constexpr std::int32_t kMostBytes = 32;

void increment(std::int32_t& count) {
  count = count == std::numeric_limits<std::int32_t>::max() ? 0 : count + 1;
}

}  // namespace

std::int64_t overlap_ns(const Span& span, std::int64_t begin_ns, std::int64_t end_ns) {
  return std::max<std::int64_t>(0, std::min(span.end_ns, end_ns) - std::max(span.begin_ns, begin_ns));
}

double distance_m(const NodeVariables& a, const NodeVariables& b) {
  double sum = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double difference = a.inputs.position_m[axis] - b.inputs.position_m[axis];
    sum += difference * difference;
  }
  return std::sqrt(sum);
}

Channel::Channel(const Parameters& parameters, std::span<NodeVariables> nodes, Log log)
    : parameters_(parameters), variables_(nodes), log_(std::move(log)), nodes_(nodes.size()) {
  for (std::size_t i = 0; i < nodes.size(); ++i) nodes_[i].count = nodes[i].inputs.tx_count;
}

void Channel::step(const Span& span) {
  ended_.clear();
  take_requests(span.begin_ns);
  transmit(span.end_ns);
  decide(span.end_ns);
  deliver(span.end_ns);
  write_outputs();
}

void Channel::take_requests(std::int64_t time_ns) {
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    auto& node = nodes_[i];
    const auto& inputs = variables_[i].inputs;
    if (inputs.tx_count == node.count) continue;
    node.count = inputs.tx_count;
    ++node.packets;  // counts dropped packets too, so that a drop does not change the random numbers of later packets
    const auto most = static_cast<std::int32_t>(nodes_.size());
    if (inputs.tx_size < 0 || inputs.tx_size > kMostBytes)
      throw Error(fmt::format("node[{}].tx.size = {} must be 0 to {} bytes", i + 1, inputs.tx_size, kMostBytes));
    if (inputs.tx_to < 0 || inputs.tx_to > most)
      throw Error(
          fmt::format("node[{}].tx.to = {} must be 0 to send to all nodes, or the number of a node from 1 to {}", i + 1,
                      inputs.tx_to, most));
    if (node.to_send.size() == kQueue) {
      increment(variables_[i].outputs.tx_dropped);
      if (variables_[i].outputs.tx_dropped == 1)
        log_(fmt::format("node[{}]: a packet was dropped, because {} wait to be sent; tx.dropped counts them", i + 1,
                         kQueue));
      continue;
    }
    Packet packet;
    packet.requested_ns = time_ns;
    packet.from = static_cast<std::int32_t>(i) + 1;
    packet.to = inputs.tx_to;
    packet.size = inputs.tx_size;
    packet.number = node.packets;
    packet.data = inputs.tx_data;
    node.to_send.push_back(packet);
  }
}

/// Returns the node with the oldest request. If requests have the same time, the node after the last sender is first.
Channel::Node* Channel::next_sender() {
  Node* chosen = nullptr;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    auto& node = nodes_[(static_cast<std::size_t>(last_sender_) + i) % nodes_.size()];
    if (node.to_send.empty()) continue;
    if (chosen == nullptr || node.to_send.front().requested_ns < chosen->to_send.front().requested_ns) chosen = &node;
  }
  return chosen;
}

void Channel::transmit(std::int64_t end_ns) {
  while (auto* node = next_sender()) {
    auto packet = node->to_send.front();
    packet.begin_ns = std::max(free_ns_, packet.requested_ns);
    if (packet.begin_ns >= end_ns) return;
    node->to_send.erase(node->to_send.begin());
    const auto airtime = airtime_ns(parameters_, packet.size);
    packet.end_ns = packet.begin_ns + nanoseconds(parameters_.packet_settling_s) + airtime;
    free_ns_ = packet.end_ns;
    last_sender_ = packet.from;
    auto& outputs = variables_[static_cast<std::size_t>(packet.from) - 1].outputs;
    increment(outputs.tx_sent);
    outputs.tx_airtime_s += static_cast<double>(airtime) * 1e-9;
    on_air_.push_back(packet);
  }
}

void Channel::decide(std::int64_t end_ns) {
  while (!on_air_.empty() && on_air_.front().end_ns <= end_ns) {  // packets are in the order of their ends
    const auto& packet = on_air_.front();
    ended_.push_back(packet);
    under_way_.push_back({packet, receptions(packet)});
    on_air_.erase(on_air_.begin());
  }
}

std::vector<Channel::Reception> Channel::receptions(const Packet& packet) const {
  const auto sender = static_cast<std::size_t>(packet.from) - 1;
  std::vector<Reception> all;
  for (std::size_t node = 0; node < nodes_.size(); ++node) {
    const auto number = static_cast<std::int32_t>(node) + 1;
    if (number == packet.from || (packet.to != 0 && packet.to != number)) continue;
    const double power = received_power_w(parameters_, distance_m(variables_[sender], variables_[node]));
    const double draw =
        uniform(parameters_.seed, {Purpose::packet, sender, node, static_cast<std::uint64_t>(packet.number)});
    const bool lost = draw < loss_probability(parameters_, power, bits_of(parameters_, packet.size));
    all.push_back({node, lost, power});
  }
  return all;
}

void Channel::deliver(std::int64_t end_ns) {
  const auto latency = nanoseconds(parameters_.packet_latency_s);
  while (!under_way_.empty() && under_way_.front().packet.end_ns + latency <= end_ns) {
    const auto& [packet, receptions] = under_way_.front();
    for (const auto& reception : receptions) receive(packet, reception);
    under_way_.erase(under_way_.begin());
  }
}

void Channel::receive(const Packet& packet, const Reception& reception) {
  auto& outputs = variables_[reception.node].outputs;
  auto& received = nodes_[reception.node].received;
  if (reception.lost) {
    increment(outputs.rx_lost);
  } else if (received.size() == kQueue) {
    increment(outputs.rx_dropped);
  } else {
    received.push_back(packet);
    received.back().power_w = reception.power_w;
  }
}

void Channel::write_outputs() {
  const auto latency = nanoseconds(parameters_.packet_latency_s);
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    auto& received = nodes_[i].received;
    if (received.empty()) continue;
    auto& outputs = variables_[i].outputs;
    const auto& packet = received.front();
    increment(outputs.rx_count);
    outputs.rx_from = packet.from;
    outputs.rx_size = packet.size;
    outputs.rx_data = packet.data;
    outputs.rx_power_w = packet.power_w;
    outputs.rx_delay_s = static_cast<double>(packet.end_ns + latency - packet.requested_ns) * 1e-9;
    received.erase(received.begin());
  }
}

double Channel::energy_j(std::size_t node, const Span& span) const {
  std::int64_t settling_ns = 0;
  std::int64_t sending_ns = 0;
  for (const auto* packets : {&on_air_, &ended_}) {
    for (const auto& packet : *packets) {
      if (packet.from != static_cast<std::int32_t>(node) + 1) continue;
      const auto first_bit = packet.end_ns - airtime_ns(parameters_, packet.size);
      settling_ns += overlap_ns(span, packet.begin_ns, first_bit);
      sending_ns += overlap_ns(span, first_bit, packet.end_ns);
    }
  }
  const auto listening_ns = span.end_ns - span.begin_ns - settling_ns - sending_ns;
  return parameters_.packet_voltage_v * 1e-9 *
         (parameters_.packet_settling_current_a * static_cast<double>(settling_ns) +
          parameters_.packet_transmit_current_a * static_cast<double>(sending_ns) +
          parameters_.packet_listen_current_a * static_cast<double>(listening_ns));
}

void Channel::Packet::visit(state::Visitor& v) {
  v("requested_ns", requested_ns);
  v("begin_ns", begin_ns);
  v("end_ns", end_ns);
  v("from", from);
  v("to", to);
  v("size", size);
  v("number", number);
  v("power_w", power_w);
  v("data", data);
}

void Channel::Reception::visit(state::Visitor& v) {
  v("node", node);
  v("lost", lost);
  v("power_w", power_w);
}

void Channel::Transfer::visit(state::Visitor& v) {
  v("packet", packet);
  v("receptions", receptions);
}

void Channel::Node::visit(state::Visitor& v) {
  v("count", count);
  v("packets", packets);
  v("to_send", to_send);
  v("received", received);
}

void Channel::visit(state::Visitor& v) {
  v("nodes", std::span(nodes_));
  v("on_air", on_air_);
  v("under_way", under_way_);
  v("free_ns", free_ns_);
  v("last_sender", last_sender_);
  if (v.restores()) ended_.clear();
}

}  // namespace mebots::radio
