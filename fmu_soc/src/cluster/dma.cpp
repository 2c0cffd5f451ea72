// SPDX-License-Identifier: Apache-2.0
#include "cluster/dma.hpp"

#include "fmu_soc_board/board.hpp"
#include "mebots/assert.hpp"

#include <algorithm>
#include <cstring>
#include <type_traits>

namespace mebots::soc {
namespace {

namespace dma_reg = board::cluster_dma;
constexpr std::uint32_t kIn = 1;
constexpr std::uint32_t kOut = 2;

}  // namespace

void ClusterDma::reset() {
  drafts_ = {};
  transfers_ = {};
  next_ = kNoTick;
  free_from_ = 0;
  status_ = 0;
}

BusReply ClusterDma::load(unsigned who, std::uint32_t offset) const {
  MEBOTS_ASSERT(who < drafts_.size());
  const auto& draft = drafts_[who];
  switch (offset) {
    case dma_reg::kL2Address:
      return BusReply::done(draft.l2);
    case dma_reg::kL1Address:
      return BusReply::done(draft.l1);
    case dma_reg::kSize:
      return BusReply::done(draft.size);
    case dma_reg::kRow:
      return BusReply::done(draft.row);
    case dma_reg::kStride:
      return BusReply::done(draft.stride);
    case dma_reg::kStart:
      return BusReply::done(draft.id);
    case dma_reg::kStatus: {
      auto status = status_;
      for (unsigned id = 0; id < kTransfers; ++id) status |= transfers_[id].end != kNoTick ? 1U << id : 0U;
      return BusReply::done(status);
    }
    default:
      return {};
  }
}

bool ClusterDma::store(unsigned who, std::uint32_t offset, std::uint32_t value, std::uint64_t tick) {
  MEBOTS_ASSERT(who < drafts_.size());
  auto& draft = drafts_[who];
  switch (offset) {
    case dma_reg::kL2Address:
      draft.l2 = value;
      return true;
    case dma_reg::kL1Address:
      draft.l1 = value;
      return true;
    case dma_reg::kSize:
      draft.size = value;
      return true;
    case dma_reg::kRow:
      draft.row = value;
      return true;
    case dma_reg::kStride:
      draft.stride = value;
      return true;
    case dma_reg::kStart:
      start(who, value, tick);
      return true;
    case dma_reg::kStatus:
      status_ &= ~(value & kRefused);
      return true;
    default:
      return false;
  }
}

bool ClusterDma::fits(const Draft& draft) const {
  MEBOTS_ASSERT(l1_region_ < memory_.regions().size());
  if (draft.size == 0) return false;
  const auto row = draft.row == 0 ? draft.size : draft.row;
  const auto last_row = (draft.size - 1) / row;
  const auto span = std::uint64_t{last_row} * draft.stride + std::max(row, draft.size - last_row * row);
  if (span > 0xffffffffU) return false;
  const auto* l2 = memory_.find(draft.l2, static_cast<std::uint32_t>(span));
  const auto& l1 = memory_.regions()[l1_region_];
  return l2 != nullptr && l2 != &l1 && l1.holds(draft.l1, draft.size);
}

std::uint32_t ClusterDma::cycles_of(const Draft& draft) const {
  const auto cycles_of_bytes = [this](std::uint32_t bytes) {
    const auto beats = (bytes + timing_.bytes_per_cycle - 1) / timing_.bytes_per_cycle;
    return std::max(timing_.ticks_of(beats), timing_.least_burst_cycles);
  };
  const auto cycles_of_row = [&](std::uint32_t bytes) {
    const auto whole = bytes / timing_.most_burst_bytes;
    const auto rest = bytes % timing_.most_burst_bytes;
    return whole * cycles_of_bytes(timing_.most_burst_bytes) + (rest == 0 ? 0 : cycles_of_bytes(rest));
  };
  const auto row = draft.row == 0 ? draft.size : draft.row;
  MEBOTS_ASSERT(row > 0);
  return draft.size / row * cycles_of_row(row) + cycles_of_row(draft.size % row);
}

bool ClusterDma::has_room() const {
  return std::ranges::any_of(transfers_, [](const auto& t) { return t.end == kNoTick; });
}

bool ClusterDma::enqueue(unsigned who, const Draft& what, bool out, std::uint64_t tick) {
  const auto free = std::find_if(transfers_.begin(), transfers_.end(), [](const auto& t) { return t.end == kNoTick; });
  if (free == transfers_.end() || !fits(what)) return false;
  const auto cycles = cycles_of(what);
  MEBOTS_ASSERT(cycles > 0);
  const auto first_beat = std::max(free_from_, tick + timing_.latency);
  *free = {what, out ? 1U : 0U, who, first_beat + cycles, first_beat};
  free_from_ = free->end;
  MEBOTS_ASSERT(free->end > tick, "a transfer takes time");
  find_next();
  counts_.busy_cycles += cycles;
  counts_.bytes += what.size;
  ++counts_.transfers;
  return true;
}

void ClusterDma::start(unsigned who, std::uint32_t direction, std::uint64_t tick) {
  auto& draft = drafts_[who];
  const auto free = std::find_if(transfers_.begin(), transfers_.end(), [](const auto& t) { return t.end == kNoTick; });
  const bool has_whole_rows = draft.row == 0 || draft.size % draft.row == 0;
  auto what = draft;
  what.id = static_cast<std::uint32_t>(free - transfers_.begin());
  if ((direction == kIn || direction == kOut) && has_whole_rows && enqueue(who, what, direction == kOut, tick)) {
    draft.id = what.id;
  } else {
    status_ |= kRefused;
  }
}

void ClusterDma::find_next() {
  next_ = kNoTick;
  for (const auto& transfer : transfers_) next_ = std::min(next_, transfer.end);
}

/// Returns the earliest transfer that has not moved all its bytes, or null if all transfers have moved their bytes.
ClusterDma::Transfer* ClusterDma::first_unmoved() {
  Transfer* first = nullptr;
  for (auto& transfer : transfers_) {
    if (transfer.end == kNoTick || transfer.moved == transfer.what.size) continue;
    if (first == nullptr || transfer.end < first->end) first = &transfer;
  }
  return first;
}

void ClusterDma::occupy(Banks& banks, std::uint64_t until) {
  if (!busy()) return;
  for (auto* transfer = first_unmoved(); transfer != nullptr && transfer->next_beat < until;
       transfer = first_unmoved()) {
    std::uint64_t waited = 0;
    while (transfer->moved < transfer->what.size && transfer->next_beat < until) {
      waited += occupy_burst(banks, *transfer, until);
    }
    if (waited == 0) continue;
    // A wait of this transfer also delays the transfers that were queued later.
    for (auto& other : transfers_) {
      if (other.end == kNoTick || other.end < transfer->end || &other == transfer) continue;
      other.next_beat += waited;
      other.end += waited;
    }
    transfer->end += waited;
    free_from_ += waited;
    counts_.busy_cycles += waited;
    find_next();
  }
}

/// Claims banks for the next beats of a burst that start before `until`. Returns the number of ticks for which these
/// beats wait.
std::uint64_t ClusterDma::occupy_burst(Banks& banks, Transfer& transfer, std::uint64_t until) const {
  const auto& what = transfer.what;
  const auto row = what.row == 0 ? what.size : what.row;
  const auto in_row = transfer.moved % row;
  auto in_burst = in_row % timing_.most_burst_bytes;
  const auto left_in_row = std::min(row - in_row, what.size - transfer.moved);
  const auto burst = std::min(left_in_row + in_burst, timing_.most_burst_bytes);
  const auto begin = what.l1 + transfer.moved - in_burst;
  std::uint64_t waited = 0;
  while (in_burst < burst && transfer.next_beat < until) {
    const auto end = std::min(in_burst + timing_.bytes_per_cycle, burst);
    const auto wait = banks.claim_or_next(transfer.next_beat, (begin + in_burst) & ~3U, begin + end);
    transfer.moved += end - in_burst;
    MEBOTS_ASSERT(end > in_burst);
    MEBOTS_ASSERT(transfer.moved <= what.size, "beats end with the transfer");
    const auto beat = in_burst / timing_.bytes_per_cycle;
    transfer.next_beat += wait + timing_.ticks_of(beat + 1) - timing_.ticks_of(beat);
    waited += wait;
    in_burst = end;
  }
  if (in_burst == burst) {
    const auto ticks = timing_.ticks_of((burst - 1) / timing_.bytes_per_cycle + 1);
    transfer.next_beat += std::max(ticks, timing_.least_burst_cycles) - ticks;
  }
  return waited;
}

void ClusterDma::advance(std::uint64_t tick, TransferListener& listener) {
  while (next_ <= tick && next_ != kNoTick) {
    const auto due = next_;
    const auto transfer =
        std::find_if(transfers_.begin(), transfers_.end(), [due](const auto& t) { return t.end == due; });
    MEBOTS_ASSERT(transfer != transfers_.end(), "the least end is that of a transfer");
    move(*transfer);
    transfer->end = kNoTick;
    find_next();
    listener.transfer_ended(transfer->who, transfer->what.id, due);
  }
}

void ClusterDma::move(const Transfer& transfer) {
  const auto& what = transfer.what;
  const auto row = what.row == 0 ? what.size : what.row;
  auto* l1_region = &memory_.regions()[l1_region_];
  auto* l2_region = memory_.find(what.l2, 1);
  MEBOTS_ASSERT(l2_region != nullptr && l1_region->holds(what.l1, what.size), "fits() refused the others");
  auto* l1 = l1_region->data.get() + (what.l1 - l1_region->base);
  auto* l2 = l2_region->data.get() + (what.l2 - l2_region->base);
  for (std::uint32_t done = 0; done < what.size; done += row, l1 += row, l2 += what.stride) {
    const auto bytes = std::min(row, what.size - done);
    std::memcpy(transfer.out != 0 ? l2 : l1, transfer.out != 0 ? l1 : l2, bytes);
    if (transfer.out != 0) memory_.changed(what.l2 + done / row * what.stride, bytes);
  }
  if (transfer.out == 0) memory_.changed(what.l1, what.size);
}

void ClusterDma::visit(state::Visitor& v) {
  v("drafts", drafts_);
  v("transfers", transfers_);
  v("free_from", free_from_);
  v("status", status_);
  v("counts", counts_);
  if (v.restores()) find_next();
}

}  // namespace mebots::soc
