// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/bytes.hpp"

#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <string>

namespace mebots::soc {

/// One piece of RAM. Every word has a byte of marks, which tells stores that somebody must hear of them.
struct Region {
  static constexpr std::uint8_t kCode = 1;   // decoded instructions stand here
  static constexpr std::uint8_t kWatch = 2;  // the host wants to know
  static constexpr std::uint8_t kLoop = 4;   // the last instruction of a hardware loop begins here

  std::string name;
  std::uint32_t base = 0;
  std::uint32_t size = 0;  // bytes, a multiple of 4
  std::unique_ptr<std::uint8_t[]> data;
  std::unique_ptr<std::uint8_t[]> marks;

  /// Whether `count` bytes from `address` lie inside.
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

  /// Copies bytes in or out; false, with nothing done, when they are not all in one region.
  bool read(std::uint32_t address, std::span<std::uint8_t> bytes) const;
  bool write(std::uint32_t address, std::span<const std::uint8_t> bytes);

  /// Sets marks on every word that the bytes touch.
  void mark(std::uint32_t address, std::uint32_t count, std::uint8_t marks);
  /// True when any word that the bytes touch has one of the marks.
  bool marked(std::uint32_t address, std::uint32_t count, std::uint8_t marks) const;
  /// To be called after bytes in RAM changed other than by loading a program: cores must forget what they decoded
  /// there. True when code stood there.
  bool changed(std::uint32_t address, std::uint32_t count);
  /// Grows whenever decoded instructions have become void. Cores compare it before they go on.
  std::uint64_t code_generation() const { return code_generation_; }
  /// Makes all decoded instructions void.
  void forget_code();

  /// Contents of all regions, and where hardware loops end: blocks end there, and with them the steps in which the
  /// cores of a cluster take turns. The other marks are not part of it.
  void save(state::Writer& writer) const;
  void restore(state::Reader& reader);

 private:
  std::deque<Region> regions_;
  std::uint64_t code_generation_ = 1;
};

}  // namespace mebots::soc
