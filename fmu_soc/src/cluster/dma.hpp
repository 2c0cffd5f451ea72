// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cluster/peripherals.hpp"
#include "memory/banks.hpp"
#include "memory/memory.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

namespace mebots::soc {

/// Timing of the cluster's DMA, in cluster cycles.
struct DmaTiming {
  std::uint32_t bytes_per_cycle = 8;
  std::uint32_t most_burst_bytes = 256;
  std::uint32_t latency = 16;            // cycles from the start of a transfer to its first data
  std::uint32_t outstanding = 8;         // maximum number of bursts in flight
  std::uint32_t least_burst_cycles = 2;  // least_burst_of(latency), stored for speed
  /// Ticks that a beat takes, in units of 1/kBeatUnit. A beat takes more than one tick if the SoC's clock is slower
  /// than the cluster's clock.
  std::uint32_t beat_ticks = kBeatUnit;

  std::uint32_t least_burst_of(std::uint32_t its_latency) const {
    return std::max(1U, (its_latency + outstanding - 1) / outstanding);
  }

  static constexpr std::uint32_t kBeatUnit = 1U << 16;
  std::uint32_t ticks_of(std::uint32_t beats) const {
    return static_cast<std::uint32_t>(std::uint64_t{beats} * beat_ticks / kBeatUnit);
  }
};

/// Moves bytes between L2 and the cluster's L1 while the cores run. Each requester has separate registers for its next
/// transfer. A store to START queues this transfer. Transfers run one after the other, in the order of their starts. A
/// transfer consists of bursts, and a burst of beats. A beat moves up to DmaTiming::bytes_per_cycle bytes. A row of a
/// 2D transfer takes at least one burst. The latency of a queued transfer overlaps with the previous transfer.
///
/// The words of a transfer claim banks of L1, as accesses of cores do. A beat waits at most one cycle for its bank.
/// This wait also delays all later beats. When a transfer ends, all of its bytes are copied at once, and the
/// TransferListener is called.
class ClusterDma {
 public:
  static constexpr unsigned kTransfers = 16;
  /// Status bit that is set if a START was refused, because all transfers are in use or its registers are invalid. The
  /// value must be a direction. The addresses must be in L1 and L2. The size must be a positive multiple of the row.
  static constexpr std::uint32_t kRefused = 1U << 31;

  ClusterDma(Memory& memory, std::size_t l1_region, const DmaTiming& timing)
      : memory_(memory), l1_region_(l1_region), timing_(timing) {}

  /// Sets the timing of transfers that are queued later.
  void set_timing(const DmaTiming& timing) { timing_ = timing; }

  BusReply load(unsigned who, std::uint32_t offset) const;
  bool store(unsigned who, std::uint32_t offset, std::uint32_t value, std::uint64_t tick);

  /// Describes the bytes of a transfer. The last row may be incomplete.
  struct Draft {
    std::uint32_t l2 = 0;
    std::uint32_t l1 = 0;
    std::uint32_t size = 0;
    std::uint32_t row = 0;     // bytes per row; 0 = the transfer is one row
    std::uint32_t stride = 0;  // distance in L2 from the start of a row to the start of the next row [bytes]
    std::uint32_t id = 0;      // number of the transfer that was started last

    void visit(state::Visitor& v) {
      v("l2", l2);
      v("l1", l1);
      v("size", size);
      v("row", row);
      v("stride", stride);
      v("id", id);
    }
  };

  /// Queues a transfer for `who`, a cluster core or the fabric controller. Chips with other DMA registers call this
  /// function directly. Returns false without effect if the addresses are not allowed, or if all transfers are in use.
  bool enqueue(unsigned who, const Draft& what, bool out, std::uint64_t tick);
  /// Returns true if one side of the transfer is in L1 and the other side in another memory.
  bool fits(const Draft& draft) const;
  bool has_room() const;

  /// Cancels all transfers and clears the registers for the next transfers. Does not reset the counts.
  void reset();

  bool busy() const { return next_ != kNoTick; }
  /// Claims the banks for all beats that start before tick `until`. Must be called before advance() is called for a
  /// tick up to `until`.
  void occupy(Banks& banks, std::uint64_t until);
  /// Returns the earliest tick in which a transfer can end. A wait for a bank may still delay this end, unless occupy()
  /// was called for a later tick.
  std::uint64_t next_tick() const { return next_; }
  /// Ends all transfers whose last tick is at or before `tick`, and calls the listener for each of them.
  void advance(std::uint64_t tick, TransferListener& listener);

  struct Counts {
    std::uint64_t bytes = 0;
    std::uint64_t busy_cycles = 0;  // cycles in which the DMA moves data or waits for banks
    std::uint64_t transfers = 0;

    void visit(state::Visitor& v) {
      v("bytes", bytes);
      v("busy_cycles", busy_cycles);
      v("transfers", transfers);
    }
  };
  const Counts& counts() const { return counts_; }

  void visit(state::Visitor& v);

 private:
  struct Transfer {
    Draft what;
    std::uint32_t out = 0;  // 1 = from L1 to L2; 0 = from L2 to L1
    std::uint32_t who = 0;
    std::uint64_t end = kNoTick;  // tick in which the transfer ends; kNoTick = this entry is unused
    std::uint64_t next_beat = 0;
    std::uint32_t moved = 0;  // number of bytes moved so far

    void visit(state::Visitor& v) {
      v("what", what);
      v("out", out);
      v("who", who);
      v("end", end);
      v("next_beat", next_beat);
      v("moved", moved);
    }
  };

  void start(unsigned who, std::uint32_t direction, std::uint64_t tick);
  std::uint32_t cycles_of(const Draft& draft) const;
  Transfer* first_unmoved();
  std::uint64_t occupy_burst(Banks& banks, Transfer& transfer, std::uint64_t until) const;
  void move(const Transfer& transfer);
  void find_next();

  Memory& memory_;
  std::size_t l1_region_;
  DmaTiming timing_;
  std::array<Draft, kRequesters> drafts_{};
  std::array<Transfer, kTransfers> transfers_{};
  std::uint64_t next_ = kNoTick;  // earliest tick in which a transfer ends
  std::uint64_t free_from_ = 0;   // tick in which the last queued transfer ends
  std::uint32_t status_ = 0;
  Counts counts_;
};

}  // namespace mebots::soc
