// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/instruction.hpp"
#include "hart/timing.hpp"
#include "isa/encoding.hpp"
#include "mebots/assert.hpp"
#include "memory/instruction_cache.hpp"
#include "memory/memory.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace mebots::soc {

class Banks;

/// Stores the energy of one instruction [fJ] for each operation, at the reference voltage.
struct InstructionEnergy {
  std::array<std::uint32_t, kOpCount> fj{};
};

/// Stores the settings that all harts with the same decoded code share. The instruction cache and the banks must
/// outlive the settings.
struct CodeSettings {
  Timing timing = {};
  InstructionEnergy energy = {};
  /// If true, a block that starts before the limit of a run is executed to its end. Then the instruction at which a
  /// hart stops does not depend on which code was decoded earlier.
  bool loose_limit = false;
  InstructionCache* instruction_cache = nullptr;  // cache of the instruction fetches; null = a fetch never waits
  Banks* banks = nullptr;  // banks of the first memory, if several users share it; null = the memory has one user
  bool translate = true;   // if true, hot code is translated; cycle counts and results do not depend on this setting
};

/// Stores the constant settings of one hart. CodeSettings stores those that several harts share.
struct HartSettings {
  std::uint32_t id = 0;  // value of the CSR mhartid
  /// If true, a trap jumps to the address that was written to mtvec, although mtvec reads back with some low bits
  /// cleared.
  bool keeps_written_mtvec = false;
  /// If true, the core has GAP8's 32 interrupt lines, which come from an event unit. At most one line is active at a
  /// time, and mie is not used. The vectors of interrupts start at mtvec, whose low eight bits are 0; the vectors of
  /// exceptions follow. Source: RI5CY's user manual of 2018, chapters on exceptions and CSRs.
  bool has_gap8_interrupts = false;
};

/// Describes a decoded sequence of instructions that starts at one address.
struct Block {
  std::uint32_t pc = kInvalid;
  std::uint32_t end = 0;    // address after the last instruction
  std::uint32_t first = 0;  // index of the first Instruction in the arena
  /// Largest number of cycles from the block's start to its last instruction's start if all lines are present.
  std::uint32_t last_start_bound = 0;
  std::uint32_t line_count = 0;         // number of cache lines that contain the block; 0 if there is no cache
  const std::uint8_t* lines = nullptr;  // one byte per cache line: 1 = the line is present
  bool begins_across = false;           // the first instruction extends over two cache lines
  bool unaligned = false;               // the block starts with a 32-bit instruction at an address 2 mod 4
  bool early_jump = false;              // the first or second instruction is a jump; see BlockCache::delays_jump
  std::uint64_t stalled_by = 0;         // bit r is set if the first instruction stalls after a load of register r
  mutable std::uint16_t heat = 0;       // number of interpreted runs in the epoch `epoch`
  mutable std::uint16_t absences = 0;   // number of these runs at whose start a line was absent
  mutable std::uint32_t epoch = 0;      // period of the core's cycles in which `heat` was counted
  std::uint32_t next_of_pc = 0;         // next block in the same bucket of the table by pc
  std::uint32_t next_of_page = 0;       // next block in the same bucket of the table by page

  /// Value of `pc` in an invalidated block. No valid pc is odd.
  static constexpr std::uint32_t kInvalid = 1;
  bool valid() const { return pc != kInvalid; }
  /// True if translated code should contain the refill of the block's lines in its hot path. The first absences do not
  /// count, because each line is absent at its first use.
  bool is_often_absent() const { return 2 * absences > heat + kFewAbsences; }
  /// Number of absences that do not count, of the 64 runs after which a block is hot.
  static constexpr int kFewAbsences = 8;
  /// Returns how many cycles the first instruction of the block stalls after the instruction `before`.
  std::uint32_t stall_after(const Previous& before) const {
    return is_load(before.op) && before.writes() ? static_cast<std::uint32_t>(stalled_by >> before.rd & 1U) : 0U;
  }
};

/// Is notified when blocks become invalid. Derived classes store data about decoded blocks.
class BlockListener {
 public:
  virtual ~BlockListener() = default;
  /// Called when the block `number` becomes invalid. A later block may get the same number.
  virtual void invalidated(std::uint32_t number) = 0;
  /// Called when all blocks become invalid.
  virtual void invalidated_all() = 0;
};

/// Decodes code into blocks and stores the blocks by their address. See decode-cache.md in this folder.
class BlockCache {
 public:
  static constexpr std::uint32_t kMaxBlockLength = 64;
  static constexpr std::uint32_t kMaxBlocks = 1U << 16;

  /// Reserves a mark of the memory, which must outlive the cache. If `for_translation` is true, blocks end where it
  /// suits translated code. Otherwise blocks end where it suits the interpreter.
  BlockCache(Memory& memory, const CodeSettings& settings, bool for_translation);

  const Timing& timing() const { return timing_; }

  /// Returns the number of the block that starts at `pc`. If no such block is decoded, decodes it. If `pc` cannot be
  /// fetched, returns 0.
  std::uint32_t find(std::uint32_t pc) {
    const auto number = known(pc);
    return number != 0 ? number : decode_block(pc);
  }
  /// Returns the number of the block that starts at `pc`. If no such block is decoded, returns 0.
  std::uint32_t known(std::uint32_t pc) const {
    auto number = by_pc_[bucket_of_pc(pc)];
    while (number != 0 && blocks_[number].pc != pc) number = blocks_[number].next_of_pc;
    return number;
  }
  /// Returns the block with this number. The number must have been valid once, but the block may be invalid now.
  const Block& block(std::uint32_t number) const {
    MEBOTS_ASSERT(number < blocks_.size(), "the vector of blocks never shrinks");
    return blocks_[number];
  }
  const Instruction* instructions(const Block& block) const {
    MEBOTS_ASSERT(block.first < kArenaSize);
    return &arena_[block.first];
  }
  /// Returns the link to the first block of a hardware loop's next iteration. If the link leads to another address than
  /// `start`, clears the link.
  std::uint16_t* loop_link(const Instruction& holder, std::uint32_t start) const {
    if (block(holder.link).pc != start) holder.link = 0;
    return &holder.link;
  }
  /// True if the two instructions before the block change the cycles of a jump at the start of the block. In this case,
  /// the cycles stored in the block are wrong, and single() must be used. If the jump is the block's second
  /// instruction, always returns true.
  bool delays_jump(const Block& block, const Previous& two_before, const Previous& before) const {
    return block.early_jump && before.op != Op::end_of_block && delays_first_jump(block, two_before, before);
  }
  /// Replaces the handler of an instruction, and returns the previous handler.
  Handler exchange(const Instruction* at, Handler handler) {
    MEBOTS_ASSERT(index_of(at) < kArenaSize, "single instructions stay as they are");
    return std::exchange(arena_[index_of(at)].run, handler);
  }

  /// Decodes the instruction at `pc`, for the given state of the pipeline, as a block with one instruction. If the
  /// instruction cannot be fetched, returns null. The result is cached until code changes, because loops execute the
  /// same instructions many times.
  const Instruction* single(std::uint32_t pc, const Previous& two_before, const Previous& before);

  /// Makes later blocks end after the instruction at `pc`, which is the last instruction of a hardware loop. Returns
  /// true if blocks did not end there before. In this case, decoded blocks that continue after this instruction become
  /// invalid at the next forget_if_stale().
  bool end_block_at(std::uint32_t pc);

  /// True if blocks end after the instruction at `pc`, because it may be the last instruction of a hardware loop.
  bool may_end_loop(std::uint32_t pc) const { return timing_.has_xpulp() && memory_.marked(pc, 2, Region::kLoop); }

  /// Invalidates all decoded code, also that of other cores that share the memory.
  void clear();
  /// True if code has changed since the last check. A device or another core may have changed it.
  bool is_stale() const { return code_generation_ != memory_.code_generation(); }
  /// Invalidates the blocks whose code has changed. Returns true if there are such blocks.
  bool forget_if_stale() {
    if (!is_stale()) [[likely]]
      return false;
    follow_changes();
    return true;
  }
  /// Sets the listener for invalidated blocks; null removes it.
  void set_listener(BlockListener* listener) { listener_ = listener; }
  /// Sets the maximum number of wait cycles of one bus access of the core. Time bounds of blocks use the largest value
  /// that was ever set, so that no code is decoded again when a memory is switched on or off.
  void set_longest_wait(std::uint32_t cycles);
  /// Returns the instruction cache, or null if the core has no instruction cache.
  const InstructionCache* fetched() const { return cached_lines_; }
  /// Returns the largest number of cycles from the start of the block to the start of its last instruction, if all
  /// cache lines must be fetched.
  std::uint32_t fetch_bound(const Block& block) const {
    const auto refill = cached_lines_ == nullptr ? 0U : cached_lines_->refill_cycles();
    return block.last_start_bound + block.line_count * refill;
  }
  /// True if all lines of the block are in the instruction cache, or if there is no cache.
  bool is_present(const Block& block) const {
    for (std::uint32_t i = 0; i < block.line_count; ++i) {
      if (block.lines[i] == 0) return false;
    }
    return true;
  }
  /// True if all lines of the block's first instruction are in the instruction cache. The block must have cache lines.
  bool begins_present(const Block& block) const {
    MEBOTS_ASSERT(block.line_count > 0);
    return block.lines[0] != 0 && (!block.begins_across || block.lines[1] != 0);
  }
  /// Returns a number that increases whenever blocks become invalid.
  std::uint64_t generation() const { return generation_; }
  /// Returns the number of instructions decoded into blocks since construction. An instruction that is decoded again
  /// counts again.
  std::uint64_t decoded() const { return decoded_; }

  /// Returns the instruction word at `pc`. If the word cannot be fetched, returns nullopt.
  std::optional<std::uint32_t> word_at(std::uint32_t pc) const {
    std::uint32_t word = 0;
    std::uint32_t fault_address = 0;
    return fetch(memory_, pc, word, fault_address) ? std::optional(word) : std::nullopt;
  }
  /// Decodes a word for the extensions of the core.
  Decoded decode_word(std::uint32_t word) const { return decode(word, extensions_); }
  Extensions extensions() const { return extensions_; }
  /// Reads the instruction word at `pc`. If the word cannot be fetched, returns false and sets `fault_address`.
  static bool fetch(const Memory& memory, std::uint32_t pc, std::uint32_t& word, std::uint32_t& fault_address);

 private:
  /// The arena is a ring of segments. All blocks of a segment are evicted together.
  static constexpr std::uint32_t kSegmentSize = 1U << 16;
  static constexpr std::uint32_t kSegments = 8;
  static constexpr unsigned kBucketBits = 15;
  static constexpr unsigned kPageBits = 8;  // a page has 2^kPageBits bytes; no block is longer than a page

  static constexpr std::size_t kArenaSize = std::size_t{kSegmentSize} * kSegments;

  /// Stores a single instruction, its end slot and a slot for its link. The entry is only valid for one generation of
  /// the memory's code.
  struct Single {
    /// Generation of the memory's code; 0 = empty, because the memory's generations start at 1.
    std::uint64_t generation = 0;
    Previous two_before;
    Previous before;
    std::array<Instruction, 3> slots{};
  };

  /// Frees the arena. The arena is allocated without initialisation, because clearing 16 MB would delay each start, and
  /// most programs use only a part of the arena.
  struct FreeArena {
    void operator()(Instruction* arena) const { std::allocator<Instruction>().deallocate(arena, kArenaSize); }
  };

  std::size_t index_of(const Instruction* at) const { return static_cast<std::size_t>(at - arena_.get()); }
  static std::uint32_t bucket_of_pc(std::uint32_t pc) { return ((pc >> 1) * 0x9e3779b1U) >> (32 - kBucketBits); }
  static std::uint32_t bucket_of_page(std::uint32_t pc) { return (pc >> kPageBits) & ((1U << kBucketBits) - 1); }
  struct Decoding;
  std::uint32_t decode_block(std::uint32_t pc);
  void append(Decoding& decoding, const Decoded& decoded);
  void end_block(Decoding& decoding);
  std::uint32_t add(const Block& block);
  bool leaves_soon(std::uint32_t pc) const;
  bool delays_first_jump(const Block& block, const Previous& two_before, const Previous& before) const;
  bool ends_here(const Decoding& decoding) const;
  void make_room();
  void evict(std::uint32_t segment);
  void invalidate(std::uint32_t number);
  void invalidate_overlapping(std::uint32_t address, std::uint32_t count);
  void follow_changes();
  void forget();
  Instruction instruction_of(const Decoded& decoded, std::uint32_t pc) const;
  Memory& memory_;
  std::uint8_t mark_;  // mark of the memory on words that contain decoded instructions
  Timing timing_;
  Extensions extensions_;
  std::array<std::uint32_t, kOpCount> energy_fj_;
  /// True if a block also ends at known targets of jumps and branches, so that few blocks overlap. False for harts with
  /// a loose limit, because their blocks must depend only on memory and pc.
  bool end_at_targets_;
  bool end_after_loops_;  // true if a block also ends after a backward branch
  const InstructionCache* cached_lines_;
  std::vector<Block> blocks_;         // indexed by block number; number 0 is not a block; never moves
  std::vector<std::uint32_t> free_;   // numbers of invalid blocks
  std::vector<std::uint32_t> by_pc_;  // first block of each bucket; 0 = empty bucket
  std::vector<std::uint32_t> by_page_;
  std::unique_ptr<Instruction[], FreeArena> arena_;
  std::uint32_t segment_ = 0;     // segment that is being filled
  std::uint32_t arena_used_ = 0;  // index of the next free slot in this segment
  std::uint64_t generation_ = 0;
  std::uint64_t code_generation_ = 0;  // code generation of the memory at the last check
  std::uint64_t decoded_ = 0;
  std::uint32_t longest_wait_ = 0;
  BlockListener* listener_ = nullptr;
  std::array<Single, 64> singles_{};  // indexed by low bits of the pc
};

}  // namespace mebots::soc
