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

/// Energy of one instruction by kind [fJ], at the reference voltage.
struct InstructionEnergy {
  std::array<std::uint32_t, kOpCount> fj{};
};

/// What harts have in common that share decoded code. Cache and banks outlive it.
struct CodeSettings {
  Timing timing = {};
  InstructionEnergy energy = {};
  /// A block that starts before the limit of a run runs to its end. So memory and pc alone say where a hart stops.
  bool loose_limit = false;
  InstructionCache* instruction_cache = nullptr;  // that the code comes through; null = fetching never waits
  Banks* banks = nullptr;  // of the first memory, when its users may have to wait for each other; null = one user
  bool translate = true;   // hot code to host code, where that is possible; counts are the same without
};

/// Settings of one hart, which never change; CodeSettings has those that harts share.
struct HartSettings {
  std::uint32_t id = 0;  // what mhartid reads
  /// Traps enter the address written to mtvec, also if the core clears some of its low bits.
  bool keeps_written_mtvec = false;
  /// Interrupts are those of GAP8's cores: 32 lines of an event unit, one of which is up, without mie; vectors at
  /// mtvec, whose low eight bits are 0; exceptions behind them. Source: RI5CY's user manual of 2018, chapters on
  /// exceptions and CSRs.
  bool has_gap8_interrupts = false;
};

/// Straight code from one address, decoded once.
struct Block {
  std::uint32_t pc = kInvalid;
  std::uint32_t end = 0;                // address behind it
  std::uint32_t first = 0;              // index of its first Instruction
  std::uint32_t last_start_bound = 0;   // the most cycles to its last instruction's start, all lines being there
  std::uint32_t line_count = 0;         // of the instruction cache; 0 without one
  const std::uint8_t* lines = nullptr;  // whether its lines have arrived, a byte each
  bool begins_across = false;           // its first instruction lies in two lines
  bool unaligned = false;               // starts with a 32-bit instruction at 2 mod 4
  bool early_jump = false;              // a jump is among the first two: see BlockCache::delays_jump
  std::uint64_t stalled_by = 0;         // bit r: a load of register r just before costs its first instruction a cycle
  mutable std::uint16_t heat = 0;       // how often it was interpreted in its epoch
  mutable std::uint16_t absences = 0;   // of these, how often one of its lines was not in the cache at its start
  mutable std::uint32_t epoch = 0;      // of the core's cycles
  std::uint32_t next_of_pc = 0;         // block in the same bucket of the table by pc
  std::uint32_t next_of_page = 0;       // likewise by page

  /// The pc of a block that is none, or not any more. No pc is odd.
  static constexpr std::uint32_t kInvalid = 1;
  bool valid() const { return pc != kInvalid; }
  /// Whether translated code had better expect to fetch its lines. Each is absent the first time, so a few times say
  /// nothing.
  bool is_often_absent() const { return 2 * absences > heat + kFewAbsences; }
  static constexpr int kFewAbsences = 8;  // of the 64 turns after which a block is hot
  /// What its first instruction waits for a load just before.
  std::uint32_t stall_behind(const Previous& before) const {
    return is_load(before.op) ? static_cast<std::uint32_t>(stalled_by >> before.rd & 1U) : 0U;
  }
};

/// Who keeps something of decoded blocks and must hear when one becomes invalid.
class BlockListener {
 public:
  virtual ~BlockListener() = default;
  /// The block is invalid from now on, and its number may come to mean another one.
  virtual void invalidated(std::uint32_t number) = 0;
  /// All blocks are.
  virtual void invalidated_all() = 0;
};

/// The decode cache: decoded blocks by address. See decode-cache.md beside this file.
class BlockCache {
 public:
  static constexpr std::uint32_t kMaxBlockLength = 64;
  static constexpr std::uint32_t kMaxBlocks = 1U << 16;

  /// Takes a mark of its own from the memory, which must outlive it. `for_translation`: blocks have the shape that
  /// suits translated code; else the interpreter's. All else is the same.
  BlockCache(Memory& memory, const CodeSettings& settings, bool for_translation);

  const Timing& timing() const { return timing_; }

  /// Number of the block that starts at `pc`, decoded now if need be; 0 when `pc` cannot be fetched.
  std::uint32_t find(std::uint32_t pc) {
    const auto number = known(pc);
    return number != 0 ? number : decode_block(pc);
  }
  /// Likewise, 0 when it has not been decoded.
  std::uint32_t known(std::uint32_t pc) const {
    auto number = by_pc_[bucket_of_pc(pc)];
    while (number != 0 && blocks_[number].pc != pc) number = blocks_[number].next_of_pc;
    return number;
  }
  /// A number that was right once gives the block that it means now, or an invalid one.
  const Block& block(std::uint32_t number) const {
    MEBOTS_ASSERT(number < blocks_.size(), "numbers are never taken back");
    return blocks_[number];
  }
  const Instruction* instructions(const Block& block) const {
    MEBOTS_ASSERT(block.first < kArenaSize);
    return &arena_[block.first];
  }
  /// Where to note the block of a hardware loop's next iteration, emptied when it holds that of another start.
  std::uint32_t* loop_link(const Instruction& holder, std::uint32_t start) const {
    if (block(holder.link).pc != start) holder.link = 0;
    return &holder.link;
  }
  /// Whether an early jump of the block takes other cycles behind the two instructions that came straight before it
  /// than behind nothing, as the block has it; `single` has the right ones then. Of a jump that comes second it is
  /// assumed.
  bool delays_jump(const Block& block, const Previous& two_before, const Previous& before) const {
    return block.early_jump && before.op != Op::end_of_block && delays_first_jump(block, two_before, before);
  }
  /// Puts another handler in the place of an instruction's, and gives that one back.
  Handler exchange(const Instruction* at, Handler handler) {
    MEBOTS_ASSERT(index_of(at) < kArenaSize, "single instructions stay as they are");
    return std::exchange(arena_[index_of(at)].run, handler);
  }

  /// One instruction and the end of a block, decoded with what the pipeline holds. Null when it cannot be fetched. A
  /// loop's are asked for again and again, so they are kept until code changes.
  const Instruction* single(std::uint32_t pc, const Previous& two_before, const Previous& before);

  /// A hardware loop ends with the instruction at `pc`: blocks end there from now on. True: they did not before, and
  /// those that go on behind it are invalid from the next check on, whether or not there are some.
  bool end_block_at(std::uint32_t pc);

  /// Whether the instruction at `pc` may be the last of a hardware loop: blocks end there.
  bool may_end_loop(std::uint32_t pc) const { return timing_.has_xpulp() && memory_.marked(pc, 2, Region::kLoop); }

  /// Invalidates all blocks, of other cores that share the memory too.
  void clear();
  /// Whether code has changed since the last check, by a device or another core too.
  bool is_stale() const { return code_generation_ != memory_.code_generation(); }
  /// Invalidates the blocks whose code has changed; true: it has.
  bool forget_if_stale() {
    if (!is_stale()) [[likely]]
      return false;
    follow_changes();
    return true;
  }
  /// Who hears of invalid blocks from now on, or null.
  void set_listener(BlockListener* listener) { listener_ = listener; }
  /// What one bus access of the core may wait for its way. Limits are kept with the most of all times, so that a memory
  /// that comes and goes with its supply costs no decoding.
  void set_longest_wait(std::uint32_t cycles);
  /// The cache that code comes through; null without one.
  const InstructionCache* fetched() const { return cached_lines_; }
  /// The most cycles from the start of the block to the start of its last instruction, all of whose lines may have to
  /// be fetched.
  std::uint32_t fetch_bound(const Block& block) const {
    const auto refill = cached_lines_ == nullptr ? 0U : cached_lines_->refill_cycles();
    return block.last_start_bound + block.line_count * refill;
  }
  /// Whether all lines of the block have arrived in the instruction cache, or there is none.
  bool is_present(const Block& block) const {
    for (std::uint32_t i = 0; i < block.line_count; ++i) {
      if (block.lines[i] == 0) return false;
    }
    return true;
  }
  /// Whether those of its first instruction have; only for blocks with lines.
  bool begins_present(const Block& block) const {
    MEBOTS_ASSERT(block.line_count > 0);
    return block.lines[0] != 0 && (!block.begins_across || block.lines[1] != 0);
  }
  /// Grows whenever blocks become invalid.
  std::uint64_t generation() const { return generation_; }
  /// Instructions decoded since construction, those decoded again counted again.
  std::uint64_t decoded() const { return decoded_; }

  /// The instruction word at `pc`; nothing where none can be fetched.
  std::optional<std::uint32_t> word_at(std::uint32_t pc) const {
    std::uint32_t word = 0;
    std::uint32_t fault_address = 0;
    return fetch(memory_, pc, word, fault_address) ? std::optional(word) : std::nullopt;
  }
  /// Reads an instruction word. False: it cannot be fetched, and `fault_address` is where.
  static bool fetch(const Memory& memory, std::uint32_t pc, std::uint32_t& word, std::uint32_t& fault_address);

 private:
  /// The arena is filled segment by segment, round and round; a segment's blocks are evicted together.
  static constexpr std::uint32_t kSegmentSize = 1U << 16;
  static constexpr std::uint32_t kSegments = 8;
  static constexpr unsigned kBucketBits = 15;
  static constexpr unsigned kPageBits = 8;  // no block is longer than a page

  static constexpr std::size_t kArenaSize = std::size_t{kSegmentSize} * kSegments;

  /// An instruction alone, its end, and the place of its link, as of one generation of the memory's code.
  struct Single {
    std::uint64_t generation = 0;  // 0 = nothing, which is none of the memory's
    Previous two_before;
    Previous before;
    std::array<Instruction, 3> slots{};
  };

  /// Frees an arena that was never initialised: who begins a mission would wait for 16 MB of which most decode a part.
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
  Decoded decode_word(std::uint32_t word) const {
    return decode(word, timing_.has_xpulp() ? Extension::xpulp : Extension::standard);
  }

  Memory& memory_;
  std::uint8_t mark_;  // on words of which something is decoded here
  Timing timing_;
  std::array<std::uint32_t, kOpCount> energy_fj_;
  /// Whether a block also ends where a jump or branch is known to lead, so that no instruction lies in many blocks.
  /// Not for harts with a loose limit: those must end where memory and pc alone say.
  bool end_at_targets_;
  bool end_behind_loops_;  // likewise, behind branches that lead back
  const InstructionCache* cached_lines_;
  std::vector<Block> blocks_;         // number 0 is not a block; never moves
  std::vector<std::uint32_t> free_;   // numbers of invalid blocks
  std::vector<std::uint32_t> by_pc_;  // first block of each bucket, 0 = none
  std::vector<std::uint32_t> by_page_;
  std::unique_ptr<Instruction[], FreeArena> arena_;
  std::uint32_t segment_ = 0;     // in which blocks are decoded now
  std::uint32_t arena_used_ = 0;  // index of the next free slot in it
  std::uint64_t generation_ = 0;
  std::uint64_t code_generation_ = 0;  // of the memory, at the last check
  std::uint64_t decoded_ = 0;
  std::uint32_t longest_wait_ = 0;
  BlockListener* listener_ = nullptr;
  std::array<Single, 64> singles_{};  // by pc
};

}  // namespace mebots::soc
