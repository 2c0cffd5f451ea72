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

/// Energy of one instruction [fJ] for each operation, at the reference voltage.
struct InstructionEnergy {
  std::array<std::uint32_t, kOpCount> fj{};
};

/// Settings that several harts share because they share decoded code. `instruction_cache` and `banks` must outlive the
/// settings.
struct CodeSettings {
  Timing timing = {};
  InstructionEnergy energy = {};
  /// If true, a block that starts before the limit of a run is executed to its end. The instruction at which a hart
  /// stops then does not depend on which code was decoded earlier.
  bool loose_limit = false;
  InstructionCache* instruction_cache = nullptr;  // cache for instruction fetches; null = fetches never wait
  Banks* banks = nullptr;                         // banks of the first memory; null = the memory has only one user
  bool translate = true;  // if true, hot code is translated; this setting does not change cycle counts or results
};

struct HartSettings {
  std::uint32_t id = 0;  // value of the CSR mhartid
  /// If true, a trap jumps to the address that the program wrote to mtvec, even if reads of mtvec return this address
  /// with some low bits cleared.
  bool keeps_written_mtvec = false;
  /// If true, the core has GAP8's 32 interrupt lines, which come from an event unit. At most one line is active at a
  /// time. The core ignores mie. The interrupt vectors start at mtvec, whose low eight bits are 0. The exception
  /// vectors follow them. Source: RI5CY user manual of 2018, chapters on exceptions and CSRs.
  bool has_gap8_interrupts = false;
};

/// A sequence of decoded instructions that starts at one address.
struct Block {
  std::uint32_t pc = kInvalid;
  std::uint32_t end = 0;    // address after the last instruction
  std::uint32_t first = 0;  // index of the first Instruction in the arena
  /// Largest number of cycles from the start of the block to the start of its last instruction, if the instruction
  /// cache contains the whole block.
  std::uint32_t last_start_bound = 0;
  std::uint32_t line_count = 0;         // number of cache lines that contain the block; 0 = no cache
  const std::uint8_t* lines = nullptr;  // one byte per cache line: 1 = the line is present
  bool begins_across = false;           // if true, the first instruction extends over two cache lines
  bool unaligned = false;               // if true, the block starts with a 32-bit instruction at an address 2 mod 4
  bool early_jump = false;         // if true, the first or second instruction is a jump; see BlockCache::delays_jump()
  std::uint64_t stalled_by = 0;    // bit r is set if the first instruction stalls after a load of register r
  mutable std::uint16_t heat = 0;  // number of times that the block was interpreted in the period `epoch`
  mutable std::uint16_t absences = 0;  // number of these times at which a cache line was absent at the start
  /// Number of the period in which `heat` was counted; a period is a range of the core's cycles.
  mutable std::uint32_t epoch = 0;
  std::uint32_t next_of_pc = 0;    // number of the next block in the same bucket of by_pc_
  std::uint32_t next_of_page = 0;  // number of the next block in the same bucket of by_page_

  /// Value of `pc` in an invalid block. Valid addresses are even.
  static constexpr std::uint32_t kInvalid = 1;
  bool valid() const { return pc != kInvalid; }
  /// Returns true if the block's cache lines were often absent. Translated code then contains the cache refill in its
  /// hot path. The first absences do not count, because each line is absent at its first use.
  bool is_often_absent() const { return 2 * absences > heat + kFewAbsences; }
  /// Number of absences that is_often_absent() ignores.
  static constexpr int kFewAbsences = 8;
  /// Returns how many cycles the first instruction of the block stalls if `before` is the previous instruction.
  std::uint32_t stall_after(const Previous& before) const {
    return is_load(before.op) && before.writes() ? static_cast<std::uint32_t>(stalled_by >> before.rd & 1U) : 0U;
  }
};

/// Interface for classes that store data about decoded blocks. Its functions are called when blocks become invalid.
class BlockListener {
 public:
  virtual ~BlockListener() = default;
  /// Called when the block `number` becomes invalid. A later block may get the same number.
  virtual void invalidated(std::uint32_t number) = 0;
  virtual void invalidated_all() = 0;
};

/// Decodes code into blocks, and finds blocks by their address. See decode-cache.md in this folder.
class BlockCache {
 public:
  static constexpr std::uint32_t kMaxBlockLength = 64;
  static constexpr std::uint32_t kMaxBlocks = 1U << 16;

  /// Reserves one of the memory's marks, which then marks words with decoded code. The memory must outlive the cache.
  /// If `for_translation` is true and CodeSettings::loose_limit is false, blocks also end after backward branches.
  BlockCache(Memory& memory, const CodeSettings& settings, bool for_translation);

  const Timing& timing() const { return timing_; }

  /// Returns the number of the block that starts at `pc`, and decodes the block if necessary. Returns 0 if no
  /// instruction can be fetched at `pc`.
  std::uint32_t find(std::uint32_t pc) {
    const auto number = known(pc);
    return number != 0 ? number : decode_block(pc);
  }
  /// Returns the number of the decoded block that starts at `pc`, or 0 if there is no such block.
  std::uint32_t known(std::uint32_t pc) const {
    auto number = by_pc_[bucket_of_pc(pc)];
    while (number != 0 && blocks_[number].pc != pc) number = blocks_[number].next_of_pc;
    return number;
  }
  /// Returns the block with this number. The number must have been valid once. The block may have become invalid since
  /// then.
  const Block& block(std::uint32_t number) const {
    MEBOTS_ASSERT(number < blocks_.size(), "the vector of blocks never shrinks");
    return blocks_[number];
  }
  const Instruction* instructions(const Block& block) const {
    MEBOTS_ASSERT(block.first < kArenaSize);
    return &arena_[block.first];
  }
  /// Returns a pointer to `holder.link`, the number of the block with which a hardware loop's next iteration begins. If
  /// this block does not start at address `start`, first sets the link to 0.
  std::uint16_t* loop_link(const Instruction& holder, std::uint32_t start) const {
    if (block(holder.link).pc != start) holder.link = 0;
    return &holder.link;
  }
  /// Returns true if the two instructions before the block may change the cycles of a jump that is the block's first or
  /// second instruction. The cycles stored in the block may then be wrong, and the caller must use single().
  bool delays_jump(const Block& block, const Previous& two_before, const Previous& before) const {
    return block.early_jump && before.op != Op::end_of_block && delays_first_jump(block, two_before, before);
  }
  /// Replaces the handler of an instruction, and returns the previous handler.
  Handler exchange(const Instruction* at, Handler handler) {
    MEBOTS_ASSERT(index_of(at) < kArenaSize, "single instructions stay as they are");
    return std::exchange(arena_[index_of(at)].run, handler);
  }

  /// Decodes the instruction at `pc`, for the given state of the pipeline, as a block with one instruction. Returns
  /// null if the instruction cannot be fetched. The result is cached until code changes.
  const Instruction* single(std::uint32_t pc, const Previous& two_before, const Previous& before);

  /// Makes blocks end after the instruction at `pc`, which is the last instruction of a hardware loop. Returns true if
  /// blocks did not end there before. Decoded blocks that continue after this instruction then become invalid at the
  /// next call of forget_if_stale().
  bool end_block_at(std::uint32_t pc);

  /// Returns true if blocks end after the instruction at `pc` because this instruction may be the last one of a
  /// hardware loop.
  bool may_end_loop(std::uint32_t pc) const { return timing_.has_xpulp() && memory_.marked(pc, 2, Region::kLoop); }

  /// Invalidates all decoded code, including the code that other cores decoded from the same memory.
  void clear();
  /// Returns true if code has changed since the cache last processed changes. A device or another core may change code.
  bool is_stale() const { return code_generation_ != memory_.code_generation(); }
  /// Invalidates the blocks whose code has changed. Returns true if code has changed.
  bool forget_if_stale() {
    if (!is_stale()) [[likely]]
      return false;
    follow_changes();
    return true;
  }
  /// Sets the listener, which is called when blocks become invalid; null removes it.
  void set_listener(BlockListener* listener) { listener_ = listener; }
  /// Sets the maximum number of cycles that one bus access of the core waits. Smaller values than an earlier value have
  /// no effect, so that no code must be decoded again when a memory is switched on or off.
  void set_longest_wait(std::uint32_t cycles);
  /// Returns the instruction cache, or null if the core has none.
  const InstructionCache* fetched() const { return cached_lines_; }
  /// Returns the largest number of cycles from the start of the block to the start of its last instruction, if the
  /// instruction cache contains no line of the block.
  std::uint32_t fetch_bound(const Block& block) const {
    const auto refill = cached_lines_ == nullptr ? 0U : cached_lines_->refill_cycles();
    return block.last_start_bound + block.line_count * refill;
  }
  /// Returns true if the instruction cache contains all lines of the block, or if there is no cache.
  bool is_present(const Block& block) const {
    for (std::uint32_t i = 0; i < block.line_count; ++i) {
      if (block.lines[i] == 0) return false;
    }
    return true;
  }
  /// Returns true if the instruction cache contains all lines of the block's first instruction. There must be a cache.
  bool begins_present(const Block& block) const {
    MEBOTS_ASSERT(block.line_count > 0);
    return block.lines[0] != 0 && (!block.begins_across || block.lines[1] != 0);
  }
  /// Returns a number that increases whenever blocks become invalid.
  std::uint64_t generation() const { return generation_; }
  /// Returns the number of instructions decoded into blocks since construction.
  std::uint64_t decoded() const { return decoded_; }

  /// Returns the instruction word at `pc`, or nullopt if the word cannot be fetched.
  std::optional<std::uint32_t> word_at(std::uint32_t pc) const {
    std::uint32_t word = 0;
    std::uint32_t fault_address = 0;
    return fetch(memory_, pc, word, fault_address) ? std::optional(word) : std::nullopt;
  }
  Decoded decode_word(std::uint32_t word) const { return decode(word, extensions_); }
  Extensions extensions() const { return extensions_; }
  /// Reads the instruction word at `pc`. Returns false and sets `fault_address` if the word cannot be fetched.
  static bool fetch(const Memory& memory, std::uint32_t pc, std::uint32_t& word, std::uint32_t& fault_address);

 private:
  /// The decoded instructions are in an arena, a ring of segments. To reuse a segment, all of its blocks are evicted.
  static constexpr std::uint32_t kSegmentSize = 1U << 16;
  static constexpr std::uint32_t kSegments = 8;
  static constexpr unsigned kBucketBits = 15;
  static constexpr unsigned kPageBits = 8;  // a page has 2^kPageBits bytes; no block is longer than a page

  static constexpr std::size_t kArenaSize = std::size_t{kSegmentSize} * kSegments;

  /// Stores a block with a single instruction: the instruction, the end of the block, and an Instruction whose `link`
  /// is used. Valid only while Memory::code_generation() is equal to `generation`.
  struct Single {
    /// Value of Memory::code_generation() at the decoding, at least 1; 0 = empty.
    std::uint64_t generation = 0;
    Previous two_before;
    Previous before;
    std::array<Instruction, 3> slots{};
  };

  /// Frees the arena. The arena is allocated without initialisation: clearing 16 MB would delay each start, and most
  /// programs use only a part of the arena.
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
  std::uint8_t mark_;  // bit that marks words with decoded instructions in the memory
  Timing timing_;
  Extensions extensions_;
  std::array<std::uint32_t, kOpCount> energy_fj_;
  /// If true, a block also ends at known targets of jumps and branches, so that few blocks overlap. False if
  /// CodeSettings::loose_limit is true. At its limit, a hart then stops at the end of a block, so its blocks must not
  /// depend on what was decoded earlier.
  bool end_at_targets_;
  bool end_after_loops_;  // true if a block also ends after a backward branch
  const InstructionCache* cached_lines_;
  std::vector<Block> blocks_;         // indexed by block number; number 0 is unused; the vector never reallocates
  std::vector<std::uint32_t> free_;   // numbers of invalid blocks
  std::vector<std::uint32_t> by_pc_;  // number of the first block of each bucket; 0 = empty bucket
  std::vector<std::uint32_t> by_page_;
  std::unique_ptr<Instruction[], FreeArena> arena_;
  std::uint32_t segment_ = 0;     // segment that is being filled
  std::uint32_t arena_used_ = 0;  // index of the next free slot in this segment
  std::uint64_t generation_ = 0;
  std::uint64_t code_generation_ = 0;  // code generation of the memory when the cache last processed changes
  std::uint64_t decoded_ = 0;
  std::uint32_t longest_wait_ = 0;
  BlockListener* listener_ = nullptr;
  std::array<Single, 64> singles_{};  // indexed by low bits of the pc
};

}  // namespace mebots::soc
