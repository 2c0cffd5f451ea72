// SPDX-License-Identifier: Apache-2.0
//
// Any bytes as a program: refused with an Error, or everything in it is what the platform relies on.
#include "elf/elf.hpp"

#include "mebots/error.hpp"

#include "require.hpp"

#include <cstdint>
#include <span>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using mebots::fuzz::require;
  mebots::soc::Elf elf;
  try {
    elf = mebots::soc::Elf::parse({data, size}, "program.elf");
  } catch (const mebots::Error&) {
    return 0;
  }
  bool entry_inside = false;
  for (const auto& segment : elf.segments()) {
    require(segment.size > 0, "a segment has a size");
    require(segment.bytes.size() <= segment.size, "a segment has no more bytes than it takes in memory");
    require(std::uint64_t{segment.address} + segment.size <= 0x1'0000'0000ULL, "a segment ends in the address space");
    entry_inside = entry_inside || elf.entry() - segment.address < segment.size;
    for (const auto& other : elf.segments()) {
      require(&segment == &other || segment.address >= std::uint64_t{other.address} + other.size ||
                  other.address >= std::uint64_t{segment.address} + segment.size,
              "segments do not overlap");
    }
    elf.where(segment.address);  // reads the lines of the source, too
    elf.where_called(segment.address + segment.size);
  }
  require(entry_inside, "the entry lies in a segment");
  require(elf.entry() % 2 == 0, "the entry is even");
  elf.symbol("tohost");
  elf.where(0xffffffffU);
  return 0;
}
