// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <deque>
#include <memory>
#include <span>
#include <string>

namespace mebots::soc {

/// Bytes that are 0 at first. Pages that no access touches take no memory of the host.
struct FreeBytes {
  void operator()(std::uint8_t* bytes) const { std::free(bytes); }
};
using ZeroedBytes = std::unique_ptr<std::uint8_t[], FreeBytes>;

/// A region of RAM. Every word has a byte of marks, which shows stores that a listener needs them.
struct Region {
  static constexpr std::uint8_t kCode = 1;   // instructions decoded by the first decode cache
  static constexpr std::uint8_t kWatch = 2;  // watched by the host
  static constexpr std::uint8_t kLoop = 4;   // the last instruction of a hardware loop begins here
  static constexpr std::uint8_t kAnyCode =
      0xf9;  // kCode, and what Memory::add_code_mark gives to further decode caches

  std::string name;
  std::uint32_t base = 0;
  std::uint32_t size = 0;  // bytes, a multiple of 4
  ZeroedBytes data;
  ZeroedBytes marks;

  /// True if `count` bytes from `address` are inside.
  bool holds(std::uint32_t address, std::uint32_t count) const {
    return address >= base && count <= size && address - base <= size - count;
  }
};

/// The RAM of the chip. Regions do not overlap and stay where they are.
class Memory {
 public:
  /// Throws Error when the region overlaps another one, is empty, not a multiple of 4 bytes, or passes the end.
  Region& add(const std::string& name, std::uint32_t base, std::uint32_t size);

  std::deque<Region>& regions() { return regions_; }
  const std::deque<Region>& regions() const { return regions_; }

  /// The region that holds all `count` bytes, or null.
  Region* find(std::uint32_t address, std::uint32_t count);
  const Region* find(std::uint32_t address, std::uint32_t count) const;

  /// Copies bytes in or out. Returns false, without effect, if they are not all in one region.
  bool read(std::uint32_t address, std::span<std::uint8_t> bytes) const;
  bool write(std::uint32_t address, std::span<const std::uint8_t> bytes);

  /// True if each of the `count` bytes is in some region; they may continue from one region into the next.
  bool covers(std::uint32_t address, std::uint32_t count) const;

  /// Sets marks on every word that the bytes touch.
  void mark(std::uint32_t address, std::uint32_t count, std::uint8_t marks);
  /// True when any word that the bytes touch has one of the marks.
  bool marked(std::uint32_t address, std::uint32_t count, std::uint8_t marks) const;
  /// Clears marks of every word that the bytes touch.
  void unmark(std::uint32_t address, std::uint32_t count, std::uint8_t marks);

  /// The mark of one more decode cache on what it has decoded: each has its own, so that it can take it away alone.
  /// Throws Error when there are too many.
  std::uint8_t add_code_mark();
  /// To be called after bytes in RAM changed other than by loading a program: cores must invalidate what they decoded
  /// there. True when code stood there.
  bool changed(std::uint32_t address, std::uint32_t count);
  /// Likewise, whether or not code stood there: what begins or ends there is another instruction now.
  void invalidate_code(std::uint32_t address, std::uint32_t count);
  /// Makes all decoded instructions void.
  void forget_code();

  /// Bytes whose decoded instructions have become void.
  struct Change {
    std::uint32_t address = 0;
    std::uint32_t count = 0;
  };
  /// Number of changes so far. Cores compare it before they go on.
  std::uint64_t code_generation() const { return code_generation_; }
  /// Change number `generation`, below code_generation(); null when it is too long ago, or was a change of everything.
  const Change* change(std::uint64_t generation) const {
    return generation < oldest_change_ ? nullptr : &changes_[generation % kKeptChanges];
  }

  /// Contents of all regions, and where hardware loops end: blocks end there, and with them the steps in which the
  /// cores of a cluster take turns. The other marks are not part of it.
  void visit(state::Visitor& v);

 private:
  static constexpr std::size_t kKeptChanges = 64;

  std::deque<Region> regions_;
  std::uint64_t code_generation_ = 1;
  std::uint64_t oldest_change_ = 1;
  std::array<Change, kKeptChanges> changes_{};
  unsigned code_marks_ = 0;  // given away
};

}  // namespace mebots::soc
