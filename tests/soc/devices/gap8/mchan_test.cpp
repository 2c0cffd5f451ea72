// SPDX-License-Identifier: Apache-2.0
// Tests the registers of the DMA of GAP8's cluster against archi/dma/mchan_v6.h, and its interrupts.
#include "devices/gap8/mchan.hpp"
#include "gap8_system.hpp"
#include "runtime/registers.h"
#include "support/same_state.hpp"

#include "mebots/state/save.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mebots::soc::test {
namespace {

using gap8_devices::Mchan;

class MchanTest : public testing::Test, public TransferListener {
 protected:
  static constexpr std::uint32_t kL1 = L1_BASE;
  static constexpr std::uint32_t kL2 = L2_BASE;

  MchanTest() {
    memory.add("l1", kL1, 0x10000);
    memory.add("l2", kL2, 0x10000);
  }
  void store(std::uint32_t offset, std::uint32_t value) {
    EXPECT_EQ(mchan.access(1, offset, &value, 0).kind, BusReply::Kind::done);
  }
  std::uint32_t load(std::uint32_t offset) { return mchan.access(1, offset, nullptr, 0).value; }
  void transfer_ended(unsigned /*who*/, std::uint32_t tag, std::uint64_t tick) override {
    if (const auto ended = mchan.ended(tag, tick); ended.raises_event) ++events;
  }
  void run() {
    Banks banks(16);
    while (dma.busy()) {
      dma.occupy(banks, dma.next_tick() + 1);
      dma.advance(dma.next_tick(), *this);
    }
  }
  std::vector<std::uint8_t> bytes(std::uint32_t address, std::size_t count) const {
    std::vector<std::uint8_t> read(count);
    memory.read(address, read);
    return read;
  }
  void fill(std::uint32_t address, std::size_t count) {
    std::vector<std::uint8_t> written(count);
    std::iota(written.begin(), written.end(), std::uint8_t{1});
    memory.write(address, written);
  }

  Memory memory;
  ClusterDma dma{memory, 0, {}};
  Mchan mchan{{kL1, 0x10000}, dma};
  int events = 0;
};

TEST_F(MchanTest, CopiesBytesAndCountsThemInItsCounter) {
  fill((kL2 + 0x100), 40);
  const auto counter = load(DMA_QUEUE_OFFSET);
  EXPECT_EQ(counter, 0U);
  EXPECT_EQ(load(DMA_STATUS_OFFSET), 1U << 16) << "taken, nothing to come";
  store(DMA_QUEUE_OFFSET, 40 | 1U << 16 | 1U << 17 | 1U << 19);  // 40 bytes into L1, with an event
  store(DMA_QUEUE_OFFSET, 0x200);                                // the address in L1 may be the alias
  EXPECT_FALSE(dma.busy()) << "the command is not complete";
  store(DMA_QUEUE_OFFSET, (kL2 + 0x100));
  EXPECT_EQ(load(DMA_STATUS_OFFSET), 1U << 16 | 1U);
  run();
  EXPECT_EQ(load(DMA_STATUS_OFFSET), 1U << 16);
  EXPECT_EQ(events, 1);
  EXPECT_EQ(bytes(kL1 + 0x200, 40), bytes((kL2 + 0x100), 40));
  store(DMA_STATUS_OFFSET, 1U << counter);
  EXPECT_EQ(load(DMA_STATUS_OFFSET), 0U);
}

TEST_F(MchanTest, CopiesRowsOutOfL1AndRaisesItsEventAfterTheLastOne) {
  fill(kL1, 20);
  load(DMA_QUEUE_OFFSET);
  store(DMA_QUEUE_OFFSET, 20 | 1U << 17 | 1U << 18 | 1U << 19);
  store(DMA_QUEUE_OFFSET, kL1);
  store(DMA_QUEUE_OFFSET, (kL2 + 0x400));
  store(DMA_QUEUE_OFFSET, 0x100U << 16 | 8);  // rows of 8 bytes at a distance of 256 bytes; the last row has 4 bytes
  store(DMA_QUEUE_OFFSET, 4 | 1U << 17 | 1U << 19);
  store(DMA_QUEUE_OFFSET, kL1);
  store(DMA_QUEUE_OFFSET, (kL2 + 0x800));
  run();
  EXPECT_EQ(events, 1) << "both count in one counter";
  EXPECT_EQ(bytes((kL2 + 0x400), 8), bytes(kL1, 8));
  EXPECT_EQ(bytes((kL2 + 0x500), 8), bytes(kL1 + 8, 8));
  EXPECT_EQ(bytes((kL2 + 0x600), 4), bytes(kL1 + 16, 4));
  EXPECT_EQ(bytes((kL2 + 0x604), 1).front(), 0U);
  EXPECT_EQ(bytes((kL2 + 0x800), 4), bytes(kL1, 4));
}

TEST_F(MchanTest, QueuesAnyNumberOfCommandsAndRefusesInvalidAddresses) {
  fill(kL2, 256);
  load(DMA_QUEUE_OFFSET);
  for (std::uint32_t i = 0; i < 40; ++i) {
    store(DMA_QUEUE_OFFSET, 4 | 1U << 16 | 1U << 17 | 1U << 19);
    store(DMA_QUEUE_OFFSET, 4 * i);
    store(DMA_QUEUE_OFFSET, kL2 + 4 * i);
  }
  run();
  EXPECT_EQ(events, 1);
  EXPECT_EQ(bytes(kL1, 160), bytes(kL2, 160));
  store(DMA_QUEUE_OFFSET, 4 | 1U << 16 | 1U << 17);
  store(DMA_QUEUE_OFFSET, 0);
  const std::uint32_t nowhere = 0x1D000000;
  EXPECT_EQ(mchan.access(1, DMA_QUEUE_OFFSET, &nowhere, 0).kind, BusReply::Kind::none);
}

TEST_F(MchanTest, TakesTheTimeOfItsBeatsInTheSlowerClock) {
  const auto ticks_for = [this](std::uint32_t soc_ticks_of_two_beats) {
    DmaTiming timing;
    timing.beat_ticks = soc_ticks_of_two_beats * DmaTiming::kBeatUnit / 2;
    ClusterDma slow{memory, 0, timing};
    ClusterDma::Draft what;
    what.l2 = kL2;
    what.l1 = kL1;
    what.size = 4096;
    EXPECT_TRUE(slow.enqueue(0, what, false, 0));
    return slow.next_tick();
  };
  EXPECT_EQ(ticks_for(2), 16U + 512);
  EXPECT_EQ(ticks_for(3), 16U + 512 * 3 / 2);
  EXPECT_EQ(ticks_for(4), 16U + 512 * 2);
}

/// Cores 0 and 1 loop. The end of each of 16 transfers interrupts core 0, whose handler starts the next transfer.
constexpr std::string_view kTransfers = R"(
2:  wfi
    j 2b
core: li s0, EU_BASE
    li s1, RESULTS
    li s2, 0               # transfers that have ended
    bnez a0, 3f
    li a1, 1 << CLUSTER_EVENT_DMA
    sw a1, EU_MASK_IRQ_OR_OFFSET(s0)
    j next
3:  addi a2, a2, 1         # hot, and without an access
    j 3b
fault: csrr a1, mcause
    addi s2, s2, 1
    sw s2, 0(s1)
    sw a1, 4(s1)
    li a1, 16
    beq s2, a1, 4f
next: lw a1, DMA_BASE - EU_BASE + DMA_QUEUE_OFFSET(s0)
    li a1, 4096 | 1 << 16 | 1 << 17 | 1 << 19
    sw a1, DMA_BASE - EU_BASE + DMA_QUEUE_OFFSET(s0)
    li a1, L1_BASE
    sw a1, DMA_BASE - EU_BASE + DMA_QUEUE_OFFSET(s0)
    li a1, L2_BASE
    sw a1, DMA_BASE - EU_BASE + DMA_QUEUE_OFFSET(s0)
    la a1, 3b
    csrw mepc, a1
    li a1, 0x80
    csrs mstatus, a1
    mret
4:  .insn i 0x03, 6, a4, EU_WAIT_CLEAR_OFFSET(s0)
    j 4b
)";

TEST(Gap8Cluster, InterruptsACoreAtTheEndOfATransferAsItRunsTranslatedWithAnother) {
  auto translated = timed_system(0b11, kTransfers);
  auto interpreted = timed_system(0b11, kTransfers, {.translate = false});
  translated.soc.advance(1 * kMs);
  interpreted.soc.advance(1 * kMs);
  EXPECT_TRUE(translated.faults.empty()) << translated.faults.front();
  EXPECT_EQ(translated.result(0), 16U);
  EXPECT_EQ(translated.result(1), 0x80000000U | 8U);
  EXPECT_TRUE(mebots::test::same_state(translated.soc, interpreted.soc));
}

}  // namespace
}  // namespace mebots::soc::test
