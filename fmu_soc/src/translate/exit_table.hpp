// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/assert.hpp"
#include "translate/code_memory.hpp"
#include "translate/target_table.hpp"
#include "translate/translator.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

namespace mebots::soc::translate {

/// Layout of the code memory: first the stubs, then segments that are filled in a ring. Each segment begins with its
/// patch points, which are data in pages without code.
struct Segments {
  static constexpr std::uint32_t kCount = 8;
  static constexpr std::size_t kStubBytes = 4096;
  static constexpr std::uint32_t kPatchPoints = 3U << 15;
  static constexpr std::size_t kPatchPointBytes = kPatchPoints * sizeof(const std::uint8_t*);
  static constexpr std::size_t kBytes = kPatchPointBytes + (std::size_t{6} << 20);

  static constexpr std::size_t begin_of(std::uint32_t segment) { return kStubBytes + segment * kBytes; }
  static constexpr std::size_t all_bytes() { return begin_of(kCount); }
};

/// Stores data to which translated code refers by number: exits, patch points, and targets of indirect jumps. A patch
/// point contains the address to which an exit jumps, and this address can be changed. Exits and patch points belong to
/// the segment that contains their code.
class ExitTable {
 public:
  explicit ExitTable(const CodeMemory& memory) : memory_(memory) {}

  /// Starts to fill a segment. Deletes the segment's previous exits and patch points.
  void begin_segment(std::uint32_t segment) {
    MEBOTS_ASSERT(segment < Segments::kCount);
    segment_ = segment;
    exits_[segment].clear();
    unpatched_[segment].clear();
  }

  bool was_used(std::uint32_t segment) const { return !exits_[segment].empty(); }

  std::uint32_t add(const Exit& exit) {
    exits_[segment_].push_back(exit);
    return number_of(exits_[segment_].size() - 1);
  }
  const Exit& exit(std::uint32_t number) const { return exits_[number >> kIndexBits][number & kIndexMask]; }
  std::size_t count() const { return exits_[segment_].size(); }
  const Exit& exit_in_work(std::size_t index) const {
    MEBOTS_ASSERT(index < count());
    return exits_[segment_][index];
  }

  /// Adds a patch point to the segment that is being filled. Returns its number, which is at least 1.
  std::uint32_t add_patch_point() {
    MEBOTS_ASSERT(free_patch_points() > 0);
    unpatched_[segment_].push_back(nullptr);
    return number_of(unpatched_[segment_].size());
  }
  /// Returns the address at which the target of a patch point is stored. This memory is writable.
  std::uint8_t* place_of(std::uint32_t patch_point) const {
    MEBOTS_ASSERT((patch_point & kIndexMask) != 0 && (patch_point & kIndexMask) <= Segments::kPatchPoints);
    return memory_.writable() + Segments::begin_of(patch_point >> kIndexBits) +
           ((patch_point & kIndexMask) - 1) * sizeof(const std::uint8_t*);
  }
  std::size_t free_patch_points() const { return Segments::kPatchPoints - unpatched_[segment_].size(); }
  /// Returns the address to which the jump of a patch point leads.
  const std::uint8_t* target_of(std::uint32_t patch_point) const {
    const std::uint8_t* target = nullptr;
    std::memcpy(&target, place_of(patch_point), sizeof target);
    return target;
  }
  void patch(std::uint32_t patch_point, const std::uint8_t* target) {
    std::memcpy(place_of(patch_point), &target, sizeof target);
  }
  /// Sets the target that a patch point has while it is not chained to a block. `target` must be code that leaves the
  /// region.
  void set_unpatched(std::uint32_t patch_point, const std::uint8_t* target) {
    unpatched_[patch_point >> kIndexBits][(patch_point & kIndexMask) - 1] = target;
    patch(patch_point, target);
  }
  /// Restores the target that set_unpatched() has set. Has no effect if the segment was emptied since then.
  void unpatch(std::uint32_t patch_point) {
    const auto& targets_out = unpatched_[patch_point >> kIndexBits];
    const auto index = patch_point & kIndexMask;
    if (index <= targets_out.size()) patch(patch_point, targets_out[index - 1]);
  }

  TargetTable targets;

 private:
  static constexpr unsigned kIndexBits = 20;
  static constexpr std::uint32_t kIndexMask = (1U << kIndexBits) - 1;

  std::uint32_t number_of(std::size_t index) const {
    MEBOTS_ASSERT(index <= kIndexMask);
    return segment_ << kIndexBits | static_cast<std::uint32_t>(index);
  }

  const CodeMemory& memory_;
  std::uint32_t segment_ = 0;
  std::array<std::vector<Exit>, Segments::kCount> exits_;
  /// For each segment: the target that each patch point has while it is not chained.
  std::array<std::vector<const std::uint8_t*>, Segments::kCount> unpatched_;
};

}  // namespace mebots::soc::translate
