// SPDX-License-Identifier: Apache-2.0
// Reads any bytes as an ELF program. The reader must throw Error, or return a program that the simulator can load: its
// segments fit into the address space, no byte is loaded twice, and its entry is even and inside a segment.
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
    require(std::uint64_t{segment.run_address} + segment.size <= 0x1'0000'0000ULL,
            "a segment ends in the address space");
    require(std::uint64_t{segment.load_address} + segment.bytes.size() <= 0x1'0000'0000ULL,
            "a segment is loaded in the address space");
    entry_inside = entry_inside || elf.entry() - segment.load_address < segment.bytes.size();
    for (const auto& other : elf.segments()) {
      require(&segment == &other || segment.bytes.empty() || other.bytes.empty() ||
                  segment.load_address >= std::uint64_t{other.load_address} + other.bytes.size() ||
                  other.load_address >= std::uint64_t{segment.load_address} + segment.bytes.size(),
              "no byte is loaded twice");
    }
    elf.where(segment.run_address);  // also reads the lines of the source
    elf.where_called(segment.run_address + segment.size);
  }
  require(entry_inside, "the entry lies in a segment");
  require(elf.entry() % 2 == 0, "the entry is even");
  elf.symbol("tohost");
  elf.where(0xffffffffU);
  return 0;
}
