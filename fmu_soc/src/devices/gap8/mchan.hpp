// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cluster/dma.hpp"
#include "cluster/peripherals.hpp"
#include "memory/bus.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace mebots::soc::gap8_devices {

/// Models the registers of GAP8's cluster DMA, MCHAN. A load of the queue register allocates one of 16 counters. Stores
/// into the queue register form a command: flags and size, address in L1, address in L2, and for 2D transfers step and
/// length of rows. A command adds its bytes to the counter that the core allocated last. The status register shows
/// which counters have bytes left to transfer, and which counters are allocated. A store into the status register frees
/// counters. When a counter reaches 0, the transfer that ended last raises the events of its command: 8, 9 or none, for
/// the core that issued the command or for all cores.
///
/// On silicon, a core stalls if it requests a counter while all counters are allocated, or if it issues too many
/// commands. In this model, the first case is an access fault. The second case never occurs, because the queue is
/// unlimited. Sources: archi/dma/mchan_v6.h; GVSoC's mchan_v6 for the order of words.
class Mchan {
 public:
  static constexpr unsigned kCounters = 16;

  struct L1 {
    std::uint32_t base = 0;
    std::uint32_t size = 0;  // bytes; must be a power of two
  };

  Mchan(L1 l1, ClusterDma& dma) : l1_(l1), dma_(dma) {}

  BusReply access(unsigned who, std::uint32_t offset, const std::uint32_t* stored, std::uint64_t tick);

  /// Events that the end of a transfer raises, and their receivers. All false while the counter has bytes left to
  /// transfer.
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
    ClusterDma::Draft what;  // the field `id` contains the packed tag
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
  std::uint32_t taken_ = 0;  // bit mask of the allocated counters
  std::vector<Command> waiting_;
};

}  // namespace mebots::soc::gap8_devices
