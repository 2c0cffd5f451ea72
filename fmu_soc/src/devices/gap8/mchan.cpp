// SPDX-License-Identifier: Apache-2.0
#include "devices/gap8/mchan.hpp"

#include "mebots/assert.hpp"
#include "mebots/error.hpp"

#include <algorithm>
#include <bit>

namespace mebots::soc::gap8_devices {
namespace {

constexpr std::uint32_t kCommandQueue = 0x0;
constexpr std::uint32_t kDmaStatus = 0x4;
constexpr std::uint32_t kSizeMask = 0xffff;
constexpr std::uint32_t kToL1 = 1U << 16;
constexpr std::uint32_t kIncrements = 1U << 17;
constexpr std::uint32_t kInRows = 1U << 18;
constexpr std::uint32_t kRaisesEvent = 1U << 19;
constexpr std::uint32_t kRaisesInterrupt = 1U << 20;
constexpr std::uint32_t kRaisesForAll = 1U << 21;
constexpr std::size_t kMostWords = 4;
constexpr std::uint32_t kRowMask = 0x7fff;
constexpr unsigned kStrideShift = 16;

/// A tag contains the number of bytes, the flags and the counter of a transfer.
constexpr std::uint32_t kTagFlags = kRaisesEvent | kRaisesInterrupt | kRaisesForAll;
constexpr unsigned kTagCounterShift = 24;

}  // namespace

BusReply Mchan::access(unsigned who, std::uint32_t offset, const std::uint32_t* stored, std::uint64_t tick) {
  MEBOTS_ASSERT(who < drafts_.size());
  if (offset == kCommandQueue) {
    if (stored == nullptr) return take_counter(who);
    return push(who, *stored, tick) ? BusReply::done() : BusReply{};
  }
  if (offset != kDmaStatus) return {};
  if (stored == nullptr) return BusReply::done(status());
  taken_ &= ~(*stored & ((1U << kCounters) - 1));
  return BusReply::done();
}

BusReply Mchan::take_counter(unsigned who) {
  const auto counter = static_cast<std::uint32_t>(std::countr_one(taken_));
  if (counter >= kCounters) return {};
  taken_ |= 1U << counter;
  drafts_[who].counter = counter;
  return BusReply::done(counter);
}

std::uint32_t Mchan::status() const {
  std::uint32_t status = taken_ << kCounters;
  for (unsigned counter = 0; counter < kCounters; ++counter) {
    if (bytes_to_come_[counter] != 0) status |= 1U << counter;
  }
  return status;
}

bool Mchan::push(unsigned who, std::uint32_t word, std::uint64_t tick) {
  auto& draft = drafts_[who];
  draft.words.push_back(word);
  const auto words = (draft.words.front() & kInRows) != 0 ? kMostWords : kMostWords - 1;
  if (draft.words.size() < words) return true;
  const bool started = start(who, draft, tick);
  draft.words.clear();
  return started;
}

bool Mchan::start(unsigned who, Draft& draft, std::uint64_t tick) {
  const auto flags = draft.words[0];
  const auto size = flags & kSizeMask;
  if ((flags & kIncrements) == 0) return false;  // transfers to a constant address are not supported
  Command command;
  command.who = who;
  command.out = (flags & kToL1) == 0;
  command.what.size = size;
  command.what.l1 = l1_.base + (draft.words[1] & (l1_.size - 1));
  command.what.l2 = draft.words[2];
  if ((flags & kInRows) != 0) {
    command.what.row = draft.words[3] & kRowMask;
    command.what.stride = draft.words[3] >> kStrideShift & kRowMask;
  }
  command.what.id = size | (flags & kTagFlags) | draft.counter << kTagCounterShift;
  if (waiting_.empty() && dma_.has_room()) {
    if (!dma_.enqueue(who, command.what, command.out, tick)) return false;
  } else {
    if (!dma_.fits(command.what)) return false;
    waiting_.push_back(command);
  }
  bytes_to_come_[draft.counter] += size;
  return true;
}

Mchan::Ended Mchan::ended(std::uint32_t tag, std::uint64_t tick) {
  const auto counter = tag >> kTagCounterShift & (kCounters - 1);
  bytes_to_come_[counter] -= std::min(tag & kSizeMask, bytes_to_come_[counter]);
  if (!waiting_.empty()) {
    const auto next = waiting_.front();
    waiting_.erase(waiting_.begin());
    // The command was checked before, and a transfer has just ended, so that the DMA accepts the command.
    dma_.enqueue(next.who, next.what, next.out, tick);
  }
  if (bytes_to_come_[counter] != 0) return {};
  return {(tag & kRaisesEvent) != 0, (tag & kRaisesInterrupt) != 0, (tag & kRaisesForAll) != 0};
}

void Mchan::reset() {
  drafts_ = {};
  bytes_to_come_ = {};
  taken_ = 0;
  waiting_.clear();
}

void Mchan::visit(state::Visitor& v) {
  v("drafts", drafts_);
  v("bytes_to_come", bytes_to_come_);
  v("taken", taken_);
  v("waiting", waiting_);
  for (const auto& draft : drafts_) {
    if (draft.counter >= kCounters || draft.words.size() >= kMostWords) {
      throw Error(ErrorCode::state_damaged, "a saved state is damaged: an invalid command of the cluster's DMA");
    }
  }
  for (const auto& command : waiting_) {
    if (command.who >= kRequesters) {
      throw Error(ErrorCode::state_damaged, "a saved state is damaged: a command of the cluster's DMA without a core");
    }
  }
}

}  // namespace mebots::soc::gap8_devices
