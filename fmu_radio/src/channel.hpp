// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmu_radio/variables.hpp"
#include "mebots/state/visitor.hpp"

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

namespace mebots::radio {

using Log = std::function<void(std::string_view)>;

/// The time interval of a step: [begin_ns, end_ns).
struct Span {
  std::int64_t begin_ns;
  std::int64_t end_ns;
};

/// Returns the length of the intersection of [begin, end) and the span [ns].
std::int64_t overlap_ns(const Span& span, std::int64_t begin_ns, std::int64_t end_ns);

double distance_m(const NodeVariables& a, const NodeVariables& b);

/// Transmits packets between nodes on one frequency.
/// A sender waits until the channel is free, so that packets do not collide. Packets are sent in the order of their
/// requests; for requests at the same time, the nodes take turns. A radio stores at most three packets to send and
/// three received packets, as an nRF24L01+ does. In each step, at most one received packet per node reaches the
/// outputs.
class Channel {
 public:
  static constexpr std::size_t kQueue = 3;

  Channel(const Parameters& parameters, std::span<NodeVariables> nodes, Log log);

  /// Sends and receives packets, and sets the outputs of all nodes. Throws mebots::Error if the size or the receiver of
  /// a packet is out of range.
  void step(const Span& span);

  double energy_j(std::size_t node, const Span& span) const;

  void visit(state::Visitor& v);

 private:
  struct Packet {
    std::int64_t requested_ns = 0;
    std::int64_t begin_ns = 0;  // begin of settling
    std::int64_t end_ns = 0;    // end of the last bit
    std::int32_t from = 0;      // number of the sending node, from 1
    std::int32_t to = 0;
    std::int32_t size = 0;
    std::int64_t number = 0;  // number among the sender's packets
    double power_w = 0;       // received power at the receiver
    std::array<std::int32_t, 8> data{};

    void visit(state::Visitor& v);
  };
  /// Result of a packet at one receiving node.
  struct Reception {
    std::uint64_t node = 0;  // index of the receiving node
    bool lost = false;
    double power_w = 0;

    void visit(state::Visitor& v);
  };
  /// A packet between the end of its last bit and its arrival in the queues of its receivers.
  struct Transfer {
    Packet packet;
    std::vector<Reception> receptions;

    void visit(state::Visitor& v);
  };
  struct Node {
    std::int32_t count = 0;    // value of tx.count in the last step
    std::int64_t packets = 0;  // number of packets requested so far
    std::vector<Packet> to_send;
    std::vector<Packet> received;

    void visit(state::Visitor& v);
  };

  void take_requests(std::int64_t time_ns);
  void transmit(std::int64_t end_ns);
  Node* next_sender();
  /// Decides which nodes receive each packet that has ended by `end_ns`, from the positions of the nodes in this step.
  void decide(std::int64_t end_ns);
  std::vector<Reception> receptions(const Packet& packet) const;
  void deliver(std::int64_t end_ns);
  void receive(const Packet& packet, const Reception& reception);
  void write_outputs();

  const Parameters& parameters_;
  std::span<NodeVariables> variables_;
  Log log_;
  std::vector<Node> nodes_;
  std::vector<Packet> on_air_;
  std::vector<Transfer> under_way_;
  std::vector<Packet> ended_;  // packets that ended in the last step, for the energy of that step
  std::int64_t free_ns_ = 0;   // time from which the channel is free
  std::int32_t last_sender_ = 0;
};

}  // namespace mebots::radio
