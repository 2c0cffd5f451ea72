// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cluster/dma.hpp"
#include "cluster/peripherals.hpp"
#include "memory/bus.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace mebots::soc::gap8_devices {

/// Registers of GAP8's cluster DMA, MCHAN. A load of the queue takes one of 16 counters. Stores into it make a command
/// (what, L1's address, L2's address, and for rows their step and length), which counts in the requester's last
/// counter. The status says which counters have bytes to come, and which are taken; a store gives counters back. When
/// a counter comes to 0, the requester of the last command gets events 8 or 9, as that command says.
///
/// Silicon stalls a core that asks when all counters are taken, or when too many commands wait. Here the former is an
/// access fault and the latter never happens: the queue has no end. Sources: archi/dma/mchan_v6.h; GVSoC's mchan_v6 for
/// the order of words.
class Mchan {
 public:
  static constexpr unsigned kCounters = 16;

  struct L1 {
    std::uint32_t base = 0;
    std::uint32_t size = 0;  // a power of two
  };

  Mchan(L1 l1, ClusterDma& dma) : l1_(l1), dma_(dma) {}

  BusReply access(unsigned who, std::uint32_t offset, const std::uint32_t* stored, std::uint64_t tick);

  /// Events of an ended transfer; none while its counter has bytes to come.
  struct Ended {
    bool raises_event = false;
    bool raises_interrupt = false;
    bool for_all = false;
  };
  Ended ended(std::uint32_t tag, std::uint64_t tick);

  void reset();
  void visit(state::Visitor& v);

 private:
  struct Draft {
    std::uint32_t counter = 0;
    std::vector<std::uint32_t> words;

    void visit(state::Visitor& v) {
      v("counter", counter);
      v("words", words);
    }
  };
  struct Command {
    std::uint32_t who = 0;
    ClusterDma::Draft what;  // its id: the tag, as packed below
    bool out = false;

    void visit(state::Visitor& v) {
      v("who", who);
      v("what", what);
      v("out", out);
    }
  };

  BusReply take_counter(unsigned who);
  bool push(unsigned who, std::uint32_t word, std::uint64_t tick);
  bool start(unsigned who, Draft& draft, std::uint64_t tick);
  std::uint32_t status() const;

  L1 l1_;
  ClusterDma& dma_;
  std::array<Draft, kRequesters> drafts_;
  std::array<std::uint32_t, kCounters> bytes_to_come_{};
  std::uint32_t taken_ = 0;  // counters
  std::vector<Command> waiting_;
};

}  // namespace mebots::soc::gap8_devices
