// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/instruction.hpp"
#include "hart/timing.hpp"
#include "isa/encoding.hpp"
#include "memory/instruction_cache.hpp"
#include "memory/memory.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace mebots::soc {

struct InstructionEnergy;

/// Straight code from one address, decoded once.
struct Block {
  std::uint32_t pc = 0;
  std::uint32_t end = 0;               // address behind it
  std::uint32_t first = 0;             // index of its first Instruction
  std::uint32_t last_start_bound = 0;  // the most cycles from its start to the start of its last instruction
  std::uint32_t front_end = 0;         // address behind the first branch that may lead out of it, or `end`
  std::uint32_t front_bound = 0;       // last_start_bound, and what the code behind front_end can wait for its lines
  /// Its code before this address is known to be in the instruction cache; `end` without one. What lies behind a branch
  /// that is always taken never comes there.
  mutable std::uint32_t present_end = 0;
  /// last_start_bound while all of it is known to be there, else kAbsent: whoever has fewer cycles left cannot just run
  /// it. So asking for both costs one comparison.
  mutable std::uint64_t entry_bound = 0;
  bool unaligned = false;           // starts with a 32-bit instruction at 2 mod 4
  bool early_jump = false;          // a jump is among the first two: what ran before may delay it
  std::uint64_t stalled_by = 0;     // bit r: a load of register r just before costs its first instruction a cycle
  mutable std::uint16_t heat = 0;   // how often it was interpreted in its epoch
  mutable std::uint32_t epoch = 0;  // of the core's cycles
};

/// More cycles than any core will see.
inline constexpr std::uint64_t kAbsent = std::uint64_t{1} << 62;

/// Decoded blocks by address. All memory is taken at construction; when it is full, everything is
/// forgotten and decoded again.
class BlockCache {
 public:
  static constexpr std::uint32_t kMaxBlockLength = 64;
  static constexpr std::uint32_t kTableSize = 1U << 14;
  static constexpr std::uint32_t kMaxBlocks = kTableSize / 2;

  BlockCache(Memory& memory, Timing timing, const InstructionEnergy& energy);

  const Timing& timing() const { return timing_; }

  /// Number of the block that starts at `pc`, decoded now if need be; 0 when `pc` cannot be fetched.
  std::uint32_t find(std::uint32_t pc) {
    const auto number = known(pc);
    return number != 0 ? number : decode_block(pc);
  }
  /// Likewise, 0 when it has not been decoded.
  std::uint32_t known(std::uint32_t pc) const {
    auto slot = hash(pc);
    while (table_[slot] != 0 && blocks_[table_[slot]].pc != pc) slot = (slot + 1) & (kTableSize - 1);
    return table_[slot];
  }
  const Block& block(std::uint32_t number) const { return blocks_[number]; }
  const Instruction* instructions(const Block& block) const { return &arena_[block.first]; }
  /// Puts another handler in the place of an instruction's, and gives that one back.
  Handler exchange(const Instruction* at, Handler handler) { return std::exchange(arena_[index_of(at)].run, handler); }

  /// One instruction and the end of a block, decoded with what the pipeline holds. Null when it cannot be fetched.
  const Instruction* single(std::uint32_t pc, const Previous& two_before, const Previous& before);

  /// A hardware loop ends with the instruction at `pc`: blocks end there from now on. True: they did not before, and
  /// everything was forgotten, whether or not something had been decoded otherwise.
  bool end_block_at(std::uint32_t pc);

  /// Whether the instruction at `pc` may be the last of a hardware loop: blocks end there.
  bool may_end_loop(std::uint32_t pc) const { return timing_.has_xpulp() && memory_.marked(pc, 2, Region::kLoop); }

  /// Forgets everything; links in instructions become void with it. All cores that share the memory forget, since
  /// the marks on code go too.
  void clear();
  /// Whether somebody has stored into code since the last look, a device or another core too.
  bool is_stale() const { return code_generation_ != memory_.code_generation(); }
  /// Forgets everything then; true: it has.
  bool forget_if_stale() {
    if (!is_stale()) [[likely]]
      return false;
    forget();
    return true;
  }
  /// The most that one bus access of the core waits for its way: limits are kept with it.
  void set_longest_wait(std::uint32_t cycles);
  /// Code comes through a cache with these lines from now on: a block is absent until `look_for` finds it.
  void fetch_through(const InstructionCache& cache);
  bool fetches() const { return cached_lines_ != nullptr; }
  /// Notes how much of the block is in the instruction cache.
  void look_for(std::uint32_t number);
  /// Whether the front of the block is there.
  bool is_front_present(const Block& block) const { return block.present_end >= block.front_end; }
  /// A line has left it: blocks are absent from there on. kNoLine is none.
  void left(std::uint32_t line);
  /// All lines have.
  void left_all();
  /// Grows by one with every clear: a link noted before it is void.
  std::uint64_t generation() const { return generation_; }

  /// Reads an instruction word. False: it cannot be fetched, and `fault_address` is where.
  static bool fetch(const Memory& memory, std::uint32_t pc, std::uint32_t& word, std::uint32_t& fault_address);

 private:
  static constexpr std::uint32_t kArenaSize = 1U << 16;

  std::size_t index_of(const Instruction* at) const { return static_cast<std::size_t>(at - arena_.get()); }
  static std::uint32_t hash(std::uint32_t pc) { return ((pc >> 1) * 0x9e3779b1U) >> 18; }
  std::uint32_t decode_block(std::uint32_t pc);
  void forget();
  Instruction translate(const Decoded& decoded, std::uint32_t pc) const;
  Decoded decode_word(std::uint32_t word) const {
    return decode(word, timing_.has_xpulp() ? Extension::xpulp : Extension::standard);
  }

  Memory& memory_;
  Timing timing_;
  std::array<std::uint32_t, kOpCount> energy_fj_;
  std::vector<Block> blocks_;         // number 0 is no block
  std::vector<std::uint32_t> table_;  // open addressing, 0 = free
  std::unique_ptr<Instruction[]> arena_;
  std::uint32_t block_count_ = 1;
  std::uint32_t arena_used_ = 0;
  std::uint64_t generation_ = 0;
  std::uint64_t code_generation_ = 0;  // of the memory, at the last look
  std::uint32_t longest_wait_ = 0;
  const InstructionCache* cached_lines_ = nullptr;
  std::vector<std::uint32_t> present_;  // blocks of which something is there
  std::array<Instruction, 3> single_{};
};

}  // namespace mebots::soc
