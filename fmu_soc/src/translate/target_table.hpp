// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/assert.hpp"

#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>

namespace mebots::soc::translate {

/// Maps known targets of indirect jumps to their code, for translated code. The table has one entry per two bytes of
/// 128 KiB of guest code. Real programs have about this size, so hot targets rarely evict each other.
class TargetTable {
 public:
  static constexpr std::uint32_t kStep = 2;  // number of bytes of guest code per entry
  static constexpr std::uint32_t kMask = 0x1fffe;

  struct Target {
    std::uint32_t pc;
    std::uint32_t from_jumped_to_plain;  // bytes between the two entries of the code: see Entry
    const std::uint8_t* jumped;
  };

  /// Uses calloc(), because pages that are never accessed then take no memory. All entries are then zero, so that the
  /// entry for pc 0 seems to be valid. It must be marked as empty.
  TargetTable() : targets_(static_cast<Target*>(std::calloc(kMask / kStep + 1, sizeof(Target)))) {
    if (targets_ == nullptr) throw std::bad_alloc();
    forget(0);
  }

  const Target* data() const { return targets_.get(); }
  void set(std::uint32_t pc, const std::uint8_t* jumped, const std::uint8_t* plain) {
    MEBOTS_ASSERT((pc & 1U) == 0 && jumped != nullptr && plain >= jumped);
    entry_of(pc) = {pc, static_cast<std::uint32_t>(plain - jumped), jumped};
  }
  void forget(std::uint32_t pc) {
    if (entry_of(pc).pc == pc) entry_of(pc).pc = kNone;
  }

 private:
  struct Free {
    void operator()(Target* targets) const { std::free(targets); }
  };

  static constexpr std::uint32_t kNone = 1;  // marks an empty entry; valid addresses are even
  Target& entry_of(std::uint32_t pc) { return targets_[(pc & kMask) / kStep]; }

  std::unique_ptr<Target[], Free> targets_;
};

}  // namespace mebots::soc::translate
