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

/// Frees bytes from calloc(). Pages that are never accessed take no memory of the host.
struct FreeBytes {
  void operator()(std::uint8_t* bytes) const { std::free(bytes); }
};
using ZeroedBytes = std::unique_ptr<std::uint8_t[], FreeBytes>;

/// A range of RAM. Each word has a byte of marks. A mark means that a listener must be called if the word is written.
struct Region {
  static constexpr std::uint8_t kCode = 1;   // contains instructions that the first decode cache has decoded
  static constexpr std::uint8_t kWatch = 2;  // the host watches this word
  static constexpr std::uint8_t kLoop = 4;   // contains the start of the last instruction of a hardware loop
  static constexpr std::uint8_t kAnyCode =
      0xf9;  // kCode, and the marks that Memory::add_code_mark() gives to other decode caches

  std::string name;
  std::uint32_t base = 0;
  std::uint32_t size = 0;  // bytes; a multiple of 4
  ZeroedBytes data;
  ZeroedBytes marks;

  bool holds(std::uint32_t address, std::uint32_t count) const {
    return address >= base && count <= size && address - base <= size - count;
  }
};

/// The RAM of the chip. Regions do not overlap and do not move.
class Memory {
 public:
  /// Adds a region. Throws Error if it overlaps another region, is empty, is not a multiple of 4 bytes, or exceeds the
  /// address space.
  Region& add(const std::string& name, std::uint32_t base, std::uint32_t size);

  std::deque<Region>& regions() { return regions_; }
  const std::deque<Region>& regions() const { return regions_; }

  /// Returns the region that contains all `count` bytes, or null if no region contains them.
  Region* find(std::uint32_t address, std::uint32_t count);
  const Region* find(std::uint32_t address, std::uint32_t count) const;

  /// Copy bytes out of RAM or into RAM. Return false without effect if no region contains all bytes.
  bool read(std::uint32_t address, std::span<std::uint8_t> bytes) const;
  bool write(std::uint32_t address, std::span<const std::uint8_t> bytes);

  /// Returns true if each of the `count` bytes is in a region. The bytes may be in several adjacent regions.
  bool covers(std::uint32_t address, std::uint32_t count) const;

  /// Sets marks on every word that contains one of the bytes.
  void mark(std::uint32_t address, std::uint32_t count, std::uint8_t marks);
  /// Returns true if a word that contains one of the bytes has one of the marks.
  bool marked(std::uint32_t address, std::uint32_t count, std::uint8_t marks) const;
  /// Clears marks on every word that contains one of the bytes.
  void unmark(std::uint32_t address, std::uint32_t count, std::uint8_t marks);

  /// Reserves a mark for a decode cache and returns it. Each decode cache has its own mark, so that it can clear the
  /// mark without effect on other caches. Throws Error if all marks are in use.
  std::uint8_t add_code_mark();
  /// Must be called after bytes in RAM were changed, except by loading a program. Invalidates the code that was decoded
  /// from these bytes. Returns true if there was such code.
  bool changed(std::uint32_t address, std::uint32_t count);
  /// Reports to all cores that these bytes have changed, even if no code was decoded from them. Also used if only the
  /// ends of blocks change, so that the blocks that contain these bytes must be decoded again.
  void invalidate_code(std::uint32_t address, std::uint32_t count);
  void forget_code();

  /// Bytes whose decoded instructions have become invalid.
  struct Change {
    std::uint32_t address = 0;
    std::uint32_t count = 0;
  };
  /// Returns a number that increases with each change of code. Each core compares this number before it continues.
  std::uint64_t code_generation() const { return code_generation_; }
  /// Returns the change with the number `generation`, which must be below code_generation(). Returns null if the change
  /// is too old or affected all code.
  const Change* change(std::uint64_t generation) const {
    return generation < oldest_change_ ? nullptr : &changes_[generation % kKeptChanges];
  }

  /// Visits the contents of all regions, and the marks at the ends of hardware loops. A saved state contains these
  /// marks, because they determine where blocks end. At its limit, a core of the cluster stops at the end of a block.
  void visit(state::Visitor& v);

 private:
  static constexpr std::size_t kKeptChanges = 64;

  std::deque<Region> regions_;
  std::uint64_t code_generation_ = 1;
  std::uint64_t oldest_change_ = 1;
  std::array<Change, kKeptChanges> changes_{};
  unsigned code_marks_ = 0;  // number of code marks in use
};

}  // namespace mebots::soc
