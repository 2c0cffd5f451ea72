// SPDX-License-Identifier: Apache-2.0
// Compares the radio with closed forms of airtime, path loss, packet loss, energy and noise.
#include "link_budget.hpp"
#include "mebots/error.hpp"
#include "mebots/state/save.hpp"
#include "model.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

namespace mebots::radio {
namespace {

using testing::HasSubstr;

constexpr std::int64_t kStep_ns = 2'000'000;

/// A radio network whose nodes are in a row, 1 m apart.
class Network {
 public:
  explicit Network(std::size_t count, Parameters p = {}) : parameters(p), nodes(count) {
    parameters.node_count = static_cast<std::int32_t>(count);
    for (std::size_t i = 0; i < count; ++i) nodes[i].inputs.position_m = {static_cast<double>(i), 0, 0};
    restart();
  }

  void restart() { model.emplace(parameters, nodes, 0); }
  void step(std::int64_t duration_ns = kStep_ns) {
    model->step(now_ns, duration_ns);
    now_ns += duration_ns;
  }
  void send(std::size_t from, std::int32_t to, std::int32_t size) {
    auto& in = nodes[from].inputs;
    ++in.tx_count;
    in.tx_to = to;
    in.tx_size = size;
  }

  Parameters parameters;
  std::vector<NodeVariables> nodes;
  std::optional<Model> model;
  std::int64_t now_ns = 0;
};

TEST(LinkBudget, AirtimeIsBitsOverRate) {
  Parameters p;
  // nRF24L01+: 8 bits of preamble, 40 of address, 9 of control field, 32 bytes, 16 of CRC at 2 Mbit/s.
  EXPECT_EQ(airtime_ns(p, 32), (8 + 40 + 9 + 256 + 16) * 500);
  p.packet_rate_hz = 250e3;
  EXPECT_EQ(airtime_ns(p, 1), (73 + 8) * 4000);
}

TEST(LinkBudget, PowerFallsAsFriisSays) {
  const Parameters p;
  const double wavelength_m = 299792458 / 2.45e9;
  for (const double d : {0.5, 1.0, 7.0, 100.0})
    EXPECT_NEAR(received_power_w(p, d) / (1e-3 * std::pow(wavelength_m / (4 * std::numbers::pi * d), 2)), 1, 1e-12);
  EXPECT_EQ(received_power_w(p, 0), received_power_w(p, kLeastDistance_m));
}

TEST(LinkBudget, OneBitInAThousandIsWrongAtTheSensitivity) {
  const Parameters p;
  EXPECT_NEAR(loss_probability(p, p.packet_sensitivity_w, 1), 1e-3, 1e-12);
  EXPECT_NEAR(loss_probability(p, p.packet_sensitivity_w, 329), 1 - std::pow(0.999, 329), 1e-9);
  EXPECT_LT(loss_probability(p, p.packet_sensitivity_w * 4, 329), 1e-6);
  EXPECT_GT(loss_probability(p, p.packet_sensitivity_w * 0.1, 329), 0.999);
}

TEST(Radio, APacketIsThereAfterSettlingAndAirtime) {
  Network net(3);
  net.nodes[0].inputs.tx_data = {11, -22, 0, 0, 0, 0, 0, 88};
  net.send(0, 0, 32);
  net.step();
  for (const std::size_t i : {1u, 2u}) {
    const auto& out = net.nodes[i].outputs;
    EXPECT_EQ(out.rx_count, 1);
    EXPECT_EQ(out.rx_from, 1);
    EXPECT_EQ(out.rx_size, 32);
    EXPECT_EQ(out.rx_data, net.nodes[0].inputs.tx_data);
    EXPECT_NEAR(out.rx_delay_s, 130e-6 + 329 / 2e6, 1e-9);
    EXPECT_EQ(out.rx_power_w, received_power_w(net.parameters, static_cast<double>(i)));
  }
  EXPECT_EQ(net.nodes[0].outputs.rx_count, 0);
  EXPECT_NEAR(net.nodes[0].outputs.tx_airtime_s, 329 / 2e6, 1e-12);
}

TEST(Radio, LatencyDelaysAPacketToTheStepInWhichItIsThere) {
  Parameters p;
  p.packet_latency_s = 0.005;
  Network net(2, p);
  net.send(0, 2, 8);
  for (int i = 0; i < 2; ++i) net.step();
  EXPECT_EQ(net.nodes[1].outputs.rx_count, 0);
  net.step();
  EXPECT_EQ(net.nodes[1].outputs.rx_count, 1);
}

Parameters late() {
  Parameters p;
  p.packet_latency_s = 1;
  return p;
}

/// Sends a packet to node 2. As soon as the last bit has been sent, moves this node from one position to another.
void send_and_move(Network& net, double from_m, double to_m) {
  net.nodes[1].inputs.position_m = {from_m, 0, 0};
  net.send(0, 2, 8);
  net.step();
  net.nodes[1].inputs.position_m = {to_m, 0, 0};
}

TEST(Radio, WhereANodeIsAtTheLastBitDecidesWhatItReceives) {
  constexpr double kFar_m = 1e6;
  Network leaves(2, late());
  Network comes(2, late());
  send_and_move(leaves, 5, kFar_m);
  send_and_move(comes, kFar_m, 5);
  leaves.step(1'000'000'000);
  comes.step(1'000'000'000);
  EXPECT_EQ(leaves.nodes[1].outputs.rx_count, 1);
  EXPECT_EQ(leaves.nodes[1].outputs.rx_power_w, received_power_w(leaves.parameters, 5));
  EXPECT_EQ(comes.nodes[1].outputs.rx_count, 0);
  EXPECT_EQ(comes.nodes[1].outputs.rx_lost, 1);
}

TEST(Radio, SendersOfOneTimeFollowEachOther) {
  Network net(4);
  for (const std::size_t i : {0u, 1u, 2u}) net.send(i, 4, 32);
  std::vector<double> delays;
  for (int i = 0; i < 3; ++i) {
    net.step();
    delays.push_back(net.nodes[3].outputs.rx_delay_s);
    EXPECT_EQ(net.nodes[3].outputs.rx_from, i + 1);
  }
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(delays[i], static_cast<double>(i + 1) * (130e-6 + 329 / 2e6), 2e-9);
}

TEST(Radio, AFourthPacketIsDropped) {
  Parameters p;
  p.packet_rate_hz = 10e3;  // a packet takes 33 ms
  Network net(2, p);
  for (int i = 0; i < 5; ++i) {
    net.send(0, 2, 32);
    net.step();
  }
  // The first packet is on the air, and three packets wait in the full queue.
  EXPECT_EQ(net.nodes[0].outputs.tx_sent, 1);
  EXPECT_EQ(net.nodes[0].outputs.tx_dropped, 1);
  for (int i = 0; i < 100; ++i) net.step();
  EXPECT_EQ(net.nodes[1].outputs.rx_count, 4);
}

TEST(Radio, LossIsBinomial) {
  Parameters p;
  p.packet_loss = 0.2;
  Network net(3, p);
  constexpr int kPackets = 20000;
  for (int i = 0; i < kPackets; ++i) {
    net.send(0, 0, 4);
    net.step();
  }
  const double sigma = std::sqrt(kPackets * 0.2 * 0.8);
  for (const std::size_t i : {1u, 2u}) {
    const auto& out = net.nodes[i].outputs;
    EXPECT_EQ(out.rx_count + out.rx_lost, kPackets);
    EXPECT_NEAR(out.rx_lost, kPackets * 0.2, 4 * sigma);
  }
  EXPECT_NE(net.nodes[1].outputs.rx_lost, net.nodes[2].outputs.rx_lost);  // each receiver loses other packets
}

TEST(Radio, DistanceLosesPacketsAsTheBudgetSays) {
  Network net(2);
  // At this distance, the received power is 1 dB above the sensitivity.
  const double d = std::sqrt(received_power_w(net.parameters, 1) / (1.26 * net.parameters.packet_sensitivity_w));
  net.nodes[1].inputs.position_m = {d, 0, 0};
  const double expected = loss_probability(net.parameters, 1.26 * net.parameters.packet_sensitivity_w, 73 + 32);
  constexpr int kPackets = 20000;
  for (int i = 0; i < kPackets; ++i) {
    net.send(0, 2, 4);
    net.step();
  }
  EXPECT_NEAR(net.nodes[1].outputs.rx_lost, kPackets * expected, 4 * std::sqrt(kPackets * expected * (1 - expected)));
  EXPECT_GT(expected, 0.01);
}

TEST(Radio, EnergyIsVoltageTimesCurrentTimesTimeInEachState) {
  Parameters p;
  p.packet_rate_hz = 100e3;  // packets last longer than a step
  Network net(2, p);
  for (int i = 0; i < 200; ++i) {
    if (i % 7 == 0) net.send(0, 2, 32);
    net.step(i % 3 == 0 ? 1'000'000 : kStep_ns);
  }
  for (int i = 0; i < 20; ++i) net.step();
  const double total_s = static_cast<double>(net.now_ns) * 1e-9;
  const auto& out = net.nodes[0].outputs;
  ASSERT_GT(out.tx_sent, 20);
  const double settling_s = out.tx_sent * 130e-6;
  const double uwb_j = 3.3 * 1e-6 * total_s;
  const double sender_j =
      3 * (8e-3 * settling_s + 11.3e-3 * out.tx_airtime_s + 13.5e-3 * (total_s - settling_s - out.tx_airtime_s));
  EXPECT_NEAR(out.energy_j, sender_j + uwb_j, 1e-12);
  EXPECT_NEAR(net.nodes[1].outputs.energy_j, 3 * 13.5e-3 * total_s + uwb_j, 1e-12);
}

TEST(Radio, RangingHasItsNoiseItsBiasAndItsLoss) {
  Parameters p;
  p.ranging_bias_m = 0.1;
  p.ranging_loss = 0.1;
  Network net(2, p);
  constexpr int kExchanges = 20000;
  double sum = 0;
  double squares = 0;
  int measured = 0;
  for (int i = 0; i < kExchanges; ++i) {
    ++net.nodes[0].inputs.ranging_count;
    net.nodes[0].inputs.ranging_to = 2;
    net.step();  // four messages and three replies take 1.61 ms
    if (net.nodes[0].outputs.ranging_done == measured) continue;
    measured = net.nodes[0].outputs.ranging_done;
    const double error = net.nodes[0].outputs.ranging_distance_m - 1;
    sum += error;
    squares += error * error;
  }
  EXPECT_EQ(measured + net.nodes[0].outputs.ranging_failed, kExchanges);
  EXPECT_NEAR(measured, 0.9 * kExchanges, 4 * std::sqrt(kExchanges * 0.09));
  const double mean = sum / measured;
  EXPECT_NEAR(mean, 0.1, 4 * 0.05 / std::sqrt(measured));
  EXPECT_NEAR(std::sqrt(squares / measured - mean * mean), 0.05, 4 * 0.05 / std::sqrt(2.0 * measured));
  // Both radios are busy for 1.6136 ms of each step. During this time, each radio sends two messages.
  const double busy_s = 4 * 178.4e-6 + 3 * 300e-6;
  const double exchange_j = 3.3 * (31e-3 * 2 * 178.4e-6 + 64e-3 * (busy_s - 2 * 178.4e-6) + 1e-6 * (2e-3 - busy_s));
  EXPECT_NEAR(net.nodes[1].outputs.energy_j, kExchanges * (exchange_j + 3 * 13.5e-3 * 2e-3), 1e-7);
}

TEST(Radio, NothingIsMeasuredBeyondTheRange) {
  Network net(2);
  net.nodes[1].inputs.position_m = {60.1, 0, 0};
  net.nodes[0].inputs.ranging_to = 2;
  ++net.nodes[0].inputs.ranging_count;
  net.step();
  EXPECT_EQ(net.nodes[0].outputs.ranging_failed, 1);
  EXPECT_EQ(net.nodes[0].outputs.ranging_done, 0);
}

TEST(Radio, PositionsComeAtTheirRateWithNoiseLossAndLatency) {
  Parameters p;
  p.fix_rate_hz = 100;
  p.fix_loss = 0.25;
  p.fix_latency_s = 0.02;
  Network net(2, p);
  double squares = 0;
  int fixes = 0;
  constexpr int kSteps = 50000;  // 100 s
  for (int i = 0; i < kSteps; ++i) {
    net.nodes[1].inputs.position_m = {static_cast<double>(net.now_ns) * 1e-9, 2, 3};  // 1 m/s
    net.step();
    const auto& out = net.nodes[1].outputs;
    if (out.fix_count == fixes) continue;
    fixes = out.fix_count;
    // The sample was taken one latency before the end of this step.
    EXPECT_NEAR(out.fix_m[0], static_cast<double>(net.now_ns) * 1e-9 - 0.02, 0.006);
    squares += (out.fix_m[1] - 2) * (out.fix_m[1] - 2);
  }
  EXPECT_NEAR(fixes, 10000 * 0.75, 4 * std::sqrt(10000 * 0.25 * 0.75));
  EXPECT_NEAR(std::sqrt(squares / fixes), 1e-3, 4e-3 / std::sqrt(2.0 * fixes));
}

/// Lets all nodes send and measure at random-looking times, and returns all outputs that the seed determines.
std::vector<double> traffic(Network& net, int steps) {
  std::vector<double> trace;
  for (int i = 0; i < steps; ++i) {
    for (std::size_t n = 0; n < net.nodes.size(); ++n) {
      if ((i + 3 * n) % 5 == 0) net.send(n, 0, static_cast<std::int32_t>(i % 33));
      if ((i + n) % 11 == 0) {
        net.nodes[n].inputs.ranging_to = n == 0 ? 2 : 1;
        ++net.nodes[n].inputs.ranging_count;
      }
    }
    net.step();
    for (const auto& node : net.nodes) {
      const auto& out = node.outputs;
      trace.insert(trace.end(), {static_cast<double>(out.rx_count), static_cast<double>(out.rx_from), out.rx_delay_s,
                                 static_cast<double>(out.rx_lost), out.ranging_distance_m, out.fix_m[0], out.energy_j});
    }
  }
  return trace;
}

Parameters lossy(std::int32_t seed = 1) {
  Parameters p;
  p.seed = seed;
  p.packet_loss = 0.3;
  p.ranging_loss = 0.2;
  p.fix_rate_hz = 30;
  p.packet_rate_hz = 1e6;
  return p;
}

TEST(Radio, TheSeedDeterminesEverything) {
  Network first(4, lossy());
  Network again(4, lossy());
  Network other(4, lossy(2));
  const auto trace = traffic(first, 400);
  EXPECT_EQ(trace, traffic(again, 400));
  EXPECT_NE(trace, traffic(other, 400));
}

void restore_from(Network& restored, Network& straight) {
  restored.nodes = straight.nodes;
  restored.restart();
  state::restore(*restored.model, state::save(*straight.model));
  restored.now_ns = straight.now_ns;
}

TEST(Radio, ARestoredStateContinuesWithTheSameBits) {
  Network straight(4, lossy());
  traffic(straight, 101);
  Network restored(4, lossy());
  restore_from(restored, straight);
  EXPECT_EQ(traffic(straight, 200), traffic(restored, 200));
}

TEST(Radio, ARestoredStateKnowsWhatIsUnderWay) {
  Network straight(2, late());
  send_and_move(straight, 5, 1e6);
  Network restored(2, late());
  restore_from(restored, straight);
  restored.step(1'000'000'000);
  EXPECT_EQ(restored.nodes[1].outputs.rx_count, 1);
  EXPECT_EQ(restored.nodes[1].outputs.rx_power_w, received_power_w(restored.parameters, 5));
}

/// Sends packets with the numbers 0, 1, ... to node 2, and returns the numbers that it received. If the channel is
/// slow, the queue is full when the fifth packet is sent.
std::vector<std::int32_t> received_numbers(double rate_hz) {
  Parameters p;
  p.packet_loss = 0.5;
  p.packet_rate_hz = rate_hz;
  Network net(2, p);
  std::vector<std::int32_t> numbers;
  std::int32_t seen = 0;
  for (std::int32_t i = 0; i < 40; ++i) {
    net.nodes[0].inputs.tx_data[0] = i;
    net.send(0, 2, 32);
    for (int step = 0; step < (i < 4 ? 1 : 100); ++step) {
      net.step();
      const auto& out = net.nodes[1].outputs;
      if (out.rx_count != seen) numbers.push_back(out.rx_data[0]);
      seen = out.rx_count;
    }
  }
  EXPECT_EQ(net.nodes[0].outputs.tx_dropped, rate_hz < 1e5 ? 1 : 0);
  return numbers;
}

TEST(Radio, ADroppedPacketChangesNoLossOfLaterOnes) {
  auto fast = received_numbers(2e6);
  std::erase(fast, 4);
  EXPECT_EQ(received_numbers(10e3), fast);
}

TEST(Radio, ARefusedMeasurementChangesNoNoiseOfLaterOnes) {
  const auto third = [](std::int64_t pause_ns) {
    Network net(2);
    net.nodes[0].inputs.ranging_to = 2;
    for (int i = 0; i < 3; ++i) {
      ++net.nodes[0].inputs.ranging_count;
      net.step(i == 0 ? pause_ns : 5'000'000);
    }
    return net.nodes[0].outputs;
  };
  const auto refused = third(1'000'000);  // an exchange takes 1.61 ms
  const auto patient = third(5'000'000);
  EXPECT_EQ(refused.ranging_failed, 1);
  EXPECT_EQ(patient.ranging_failed, 0);
  EXPECT_EQ(refused.ranging_distance_m, patient.ranging_distance_m);
}

TEST(Radio, RefusesWhatCannotBeSent) {
  const auto error = [](auto change, std::size_t nodes = 2) -> std::string {
    try {
      Network net(nodes);
      change(net);
      net.step();
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_THAT(error([](Network& net) { net.send(0, 2, 33); }), HasSubstr("node[1].tx.size = 33 must be 0 to 32"));
  EXPECT_THAT(error([](Network& net) { net.send(1, 3, 1); }), HasSubstr("node[2].tx.to = 3"));
  EXPECT_THAT(error([](Network& net) {
                ++net.nodes[1].inputs.ranging_count;
                net.nodes[1].inputs.ranging_to = 2;
              }),
              HasSubstr("node[2].ranging.to = 2 must be another node"));
  EXPECT_THAT(error([](Network& net) { net.nodes[0].inputs.position_m[2] = std::nan(""); }),
              HasSubstr("node[1].position.z"));
  EXPECT_THAT(error([](Network& net) {
                net.parameters.node_count = 3;
                net.restart();
              }),
              HasSubstr("node.count = 3"));
}

}  // namespace
}  // namespace mebots::radio
