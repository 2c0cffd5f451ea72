// SPDX-License-Identifier: Apache-2.0
#include "hart/block_cache.hpp"

#include "mebots/assert.hpp"

#include <algorithm>
#include <cstring>
#include <type_traits>

namespace mebots::soc {
namespace {

Current current_of(const Decoded& decoded) {
  return {decoded.op, decoded.rd, decoded.rs1, decoded.rs2, decoded.rs3, decoded.imm};
}

/// Returns a mask. Bit r is set if the instruction stalls for a cycle when it directly follows a load of register r.
std::uint64_t loads_that_stall(const Timing& timing, const Current& current) {
  std::uint64_t registers = 0;
  const auto alone = static_cycles(timing, {}, {}, current);
  for (std::uint8_t r = 1; r < kRegisters; ++r) {
    if (static_cycles(timing, {}, {Op::lw, r}, current) > alone) registers |= std::uint64_t{1} << r;
  }
  return registers;
}

std::uint8_t accesses_of(Op op) {
  return is_load(op) || is_store(op) ? 1 : 0;
}

}  // namespace

BlockCache::BlockCache(Memory& memory, const CodeSettings& settings, bool for_translation)
    : memory_(memory),
      mark_(memory.add_code_mark()),
      timing_(settings.timing),
      extensions_(settings.timing.extensions()),
      energy_fj_(settings.energy.fj),
      end_at_targets_(!settings.loose_limit),
      end_after_loops_(end_at_targets_ && for_translation),
      cached_lines_(settings.instruction_cache),
      by_pc_(std::size_t{1} << kBucketBits),
      by_page_(std::size_t{1} << kBucketBits),
      arena_(std::allocator<Instruction>().allocate(kArenaSize)) {
  static_assert(std::is_trivially_copyable_v<Instruction> && std::is_trivially_destructible_v<Instruction>,
                "an Instruction begins where it is assigned");
  blocks_.reserve(kMaxBlocks);
  free_.reserve(kMaxBlocks);
  blocks_.emplace_back();
}

bool BlockCache::fetch(const Memory& memory, std::uint32_t pc, std::uint32_t& word, std::uint32_t& fault_address) {
  fault_address = pc;
  const auto* region = memory.find(pc, 2);
  if (region == nullptr) return false;
  const auto* bytes = region->data.get() + (pc - region->base);
  std::uint16_t low = 0;
  std::memcpy(&low, bytes, 2);
  word = low;
  if (is_compressed(word)) return true;
  fault_address = pc + 2;
  if (!region->holds(pc, 4)) return false;
  std::memcpy(&word, bytes, 4);
  return true;
}

/// Converts a decoded instruction to the form in which blocks contain it. Does not set the fields that depend on the
/// previous instructions of the block.
Instruction BlockCache::instruction_of(const Decoded& decoded, std::uint32_t pc) const {
  Instruction instruction;
  instruction.run = handler_of(decoded.op, decoded.operand);
  instruction.pc = pc;
  instruction.op = decoded.op;
  instruction.imm = operand_value(decoded);
  if (decoded.op == Op::auipc || decoded.op == Op::jal || is_branch(decoded.op)) {
    instruction.imm = static_cast<std::int32_t>(pc + static_cast<std::uint32_t>(decoded.imm));
  }
  if (is_store(decoded.op) && has_step_register(traits_of(decoded.op).mode)) {
    instruction.imm = decoded.rs3;
  }
  if (is_float_multiply_add(decoded.op)) instruction.imm |= decoded.rs3 << 8;
  instruction.rd = decoded.rd == 0 ? kNoRegister : decoded.rd;
  instruction.rs1 = decoded.rs1;
  instruction.rs2 = decoded.rs2;
  MEBOTS_ASSERT(instruction.run != nullptr && instruction.rd != 0);
  return instruction;
}

/// Returns true if the instruction at `pc` or the next one ends a block or cannot be fetched.
bool BlockCache::leaves_soon(std::uint32_t pc) const {
  for (unsigned i = 0; i < 2; ++i) {
    std::uint32_t word = 0;
    std::uint32_t fault_address = 0;
    if (!fetch(memory_, pc, word, fault_address)) return true;
    const auto decoded = decode_word(word);
    if (ends_block(decoded.op)) return true;
    pc += decoded.length;
  }
  return false;
}

/// A block during its decoding. `block.end` is the address of the next instruction.
struct BlockCache::Decoding {
  Block block;
  Instruction sums;  // totals of the instructions decoded so far
  Previous two_before;
  Previous before;
  // Largest number of cycles from the block's start to the next instruction's start.
  std::uint32_t next_start_bound = 0;
  std::uint32_t target = 0;    // nearest target of the block's forward branches that is still ahead
  bool branched_back = false;  // if true, the last instruction is a branch to itself or to earlier code
  bool ends_loop = false;      // if true, the last instruction may end a hardware loop
};

/// Returns true if the block should end before the next instruction. A block ends where another block begins, and at
/// targets of its branches, because overlapping blocks cost more than changes from block to block. If blocks are
/// decoded for translation, a block also ends after a backward branch. Otherwise a loop and the code after it would be
/// one block. The time bound and the cache lines of each iteration would then include those of the code after the loop.
/// A block does not end before code that jumps within two instructions, because the cycles of such a jump depend on the
/// instructions before it.
bool BlockCache::ends_here(const Decoding& decoding) const {
  // The cycles of the next block's first two instructions may depend on the two instructions before them. Therefore
  // this block needs at least two instructions.
  if (!end_at_targets_ || decoding.sums.index < 2) return false;
  const auto pc = decoding.block.end;
  if (const auto number = known(pc); number != 0) return !blocks_[number].early_jump;
  return (pc == decoding.target || (end_after_loops_ && decoding.branched_back)) && !leaves_soon(pc);
}

std::uint32_t BlockCache::decode_block(std::uint32_t pc) {
  std::uint32_t word = 0;
  std::uint32_t fault_address = 0;
  if (!fetch(memory_, pc, word, fault_address)) return 0;
  make_room();
  MEBOTS_ASSERT(arena_used_ + kMaxBlockLength + 2 <= (segment_ + 1) * kSegmentSize, "a block stays in its segment");
  Decoding decoding;
  auto& block = decoding.block;
  block.pc = pc;
  block.end = pc;
  block.first = arena_used_;
  block.unaligned = (pc & 2U) != 0 && !is_compressed(word);
  decoding.target = pc;
  while (decoding.sums.index < kMaxBlockLength && fetch(memory_, block.end, word, fault_address)) {
    if (ends_here(decoding)) break;
    const auto decoded = decode_word(word);
    append(decoding, decoded);
    if (decoding.ends_loop || ends_block(decoded.op)) break;
  }
  end_block(decoding);
  return add(block);
}

void BlockCache::append(Decoding& decoding, const Decoded& decoded) {
  auto& block = decoding.block;
  auto& sums = decoding.sums;
  MEBOTS_ASSERT(sums.index < kMaxBlockLength);
  const auto at = block.end;
  auto& instruction = arena_[block.first + sums.index];
  instruction = instruction_of(decoded, at);
  instruction.cycles_before = sums.cycles_before;
  instruction.index = sums.index;
  instruction.accesses_before = sums.accesses_before;
  instruction.energy_before_fj = sums.energy_before_fj;
  if (sums.index == 0) block.stalled_by = loads_that_stall(timing_, current_of(decoded));
  if (is_jump(decoded.op)) {
    instruction.rs2 = timing_.hides_unaligned_target(decoding.before.op)
                          ? 1
                          : 0;  // on RI5CY, the previous instruction hides an unaligned target
    if (sums.index < 2) block.early_jump = true;
  }
  const auto cycles = static_cycles(timing_, decoding.two_before, decoding.before, current_of(decoded));
  MEBOTS_ASSERT(sums.cycles_before + cycles <= 0xffff);
  block.last_start_bound = decoding.next_start_bound;
  // A misaligned access takes two bus accesses.
  decoding.next_start_bound += cycles + most_extra_cycles(decoded.op) + 2 * longest_wait_ * accesses_of(decoded.op);
  sums.cycles_before = static_cast<std::uint16_t>(sums.cycles_before + cycles);
  sums.index = static_cast<std::uint8_t>(sums.index + 1);
  sums.accesses_before = static_cast<std::uint8_t>(sums.accesses_before + accesses_of(decoded.op));
  sums.energy_before_fj += energy_fj_[static_cast<std::size_t>(decoded.op)];
  decoding.two_before = decoding.before;
  decoding.before = executed(decoded, false);
  decoding.ends_loop = may_end_loop(at);
  if (decoding.target <= at) decoding.target = 0xffffffffU;
  decoding.branched_back = is_branch(decoded.op) && static_cast<std::uint32_t>(instruction.imm) <= at;
  if (is_branch(decoded.op) && !decoding.branched_back) {
    decoding.target = std::min(decoding.target, static_cast<std::uint32_t>(instruction.imm));
  }
  block.end = at + decoded.length;
}

/// Adds the end of a block, an Instruction with the totals of the block. Sets the fields that depend on the whole
/// block.
void BlockCache::end_block(Decoding& decoding) {
  auto& block = decoding.block;
  const auto& sums = decoding.sums;
  auto& end = arena_[block.first + sums.index];
  end = sums;
  end.op = decoding.ends_loop ? Op::loop_end : Op::end_of_block;
  end.run = handler_of(end.op);
  MEBOTS_ASSERT(sums.index > 0 && end.run != nullptr);
  end.pc = block.end;
  // This additional Instruction is only used for its `link`, the first block of a hardware loop's next iteration.
  arena_[block.first + sums.index + 1] = Instruction{};
  arena_used_ += sums.index + 2U;
  decoded_ += sums.index;
  if (cached_lines_ != nullptr) {
    const auto first_line = cached_lines_->line_of(block.pc);
    block.lines = cached_lines_->presence(block.pc);
    block.line_count = cached_lines_->line_of(block.end - 1) - first_line + 1;
    block.begins_across = cached_lines_->line_of(arena_[block.first + 1].pc - 1) != first_line;
  }
  memory_.mark(block.pc, block.end - block.pc, mark_);
}

std::uint32_t BlockCache::add(const Block& block) {
  MEBOTS_ASSERT(block.end - block.pc <= 1U << kPageBits, "it is in two pages at most");
  std::uint32_t number = 0;
  if (free_.empty()) {
    number = static_cast<std::uint32_t>(blocks_.size());
    blocks_.emplace_back();
  } else {
    number = free_.back();
    free_.pop_back();
  }
  MEBOTS_ASSERT(number != 0 && number < kMaxBlocks);
  auto& added = blocks_[number];
  added = block;
  added.next_of_pc = std::exchange(by_pc_[bucket_of_pc(block.pc)], number);
  added.next_of_page = std::exchange(by_page_[bucket_of_page(block.pc)], number);
  return number;
}

/// Frees space for one more block. If the present segment is full, or if no block number is free, evicts the blocks of
/// the next segments until there is space.
void BlockCache::make_room() {
  const auto end = (segment_ + 1) * kSegmentSize;
  const bool has_numbers = !free_.empty() || blocks_.size() < kMaxBlocks;
  if (has_numbers && arena_used_ + kMaxBlockLength + 2 <= end) return;
  do {
    segment_ = (segment_ + 1) % kSegments;
    arena_used_ = segment_ * kSegmentSize;
    evict(segment_);
  } while (free_.empty() && blocks_.size() == kMaxBlocks);
}

void BlockCache::evict(std::uint32_t segment) {
  MEBOTS_ASSERT(segment < kSegments);
  for (std::uint32_t number = 1; number < blocks_.size(); ++number) {
    if (blocks_[number].valid() && blocks_[number].first / kSegmentSize == segment) invalidate(number);
  }
}

/// Removes a block from the tables. Its instructions remain unchanged until the segment is filled again, because a hart
/// may still execute them.
void BlockCache::invalidate(std::uint32_t number) {
  MEBOTS_ASSERT(number != 0 && blocks_[number].valid());
  auto& block = blocks_[number];
  auto* link = &by_pc_[bucket_of_pc(block.pc)];
  while (*link != number) link = &blocks_[*link].next_of_pc;
  *link = block.next_of_pc;
  link = &by_page_[bucket_of_page(block.pc)];
  while (*link != number) link = &blocks_[*link].next_of_page;
  *link = block.next_of_page;
  block.pc = Block::kInvalid;
  free_.push_back(number);
  ++generation_;
  if (listener_ != nullptr) listener_->invalidated(number);
}

/// Invalidates every block that overlaps one of the words, and removes the marks of these words. A block is at most as
/// long as a page. Therefore a block that contains an address begins in the same page or in the previous page.
void BlockCache::invalidate_overlapping(std::uint32_t address, std::uint32_t count) {
  MEBOTS_ASSERT(count > 0);
  const auto last = (address + (count - 1)) | 3U;
  address &= ~3U;
  for (auto page = (address >> kPageBits) - 1;; ++page) {
    auto number = by_page_[bucket_of_page(page << kPageBits)];
    while (number != 0) {
      const auto& block = blocks_[number];
      const auto next = block.next_of_page;
      if (block.pc <= last && block.end > address) invalidate(number);
      number = next;
    }
    if (page == last >> kPageBits) break;
  }
  memory_.unmark(address, last - address + 1, mark_);
}

void BlockCache::follow_changes() {
  for (; code_generation_ != memory_.code_generation(); ++code_generation_) {
    const auto* change = memory_.change(code_generation_);
    if (change == nullptr) {
      forget();
      return;
    }
    invalidate_overlapping(change->address, change->count);
  }
}

const Instruction* BlockCache::single(std::uint32_t pc, const Previous& two_before, const Previous& before) {
  MEBOTS_ASSERT(!is_stale(), "what follows a change of code later would take the mark off again");
  auto& kept = singles_[(pc >> 1) % singles_.size()];
  const auto generation = memory_.code_generation();
  if (kept.generation == generation && kept.slots[0].pc == pc && kept.two_before == two_before &&
      kept.before == before) {
    return kept.slots.data();
  }
  std::uint32_t word = 0;
  std::uint32_t fault_address = 0;
  if (!fetch(memory_, pc, word, fault_address)) return nullptr;
  const auto decoded = decode_word(word);
  memory_.mark(pc, decoded.length, mark_);
  kept.generation = generation;
  kept.two_before = two_before;
  kept.before = before;
  auto& slots = kept.slots;
  slots[0] = instruction_of(decoded, pc);
  if (is_jump(decoded.op)) slots[0].rs2 = timing_.hides_unaligned_target(before.op) ? 1 : 0;
  slots[1] = Instruction{};
  slots[1].op = may_end_loop(pc) ? Op::loop_end : Op::end_of_block;
  slots[1].run = handler_of(slots[1].op);
  slots[1].pc = pc + decoded.length;
  slots[1].index = 1;
  MEBOTS_ASSERT(slots[0].run != nullptr && slots[1].run != nullptr);
  slots[1].cycles_before = static_cast<std::uint16_t>(static_cycles(timing_, two_before, before, current_of(decoded)));
  slots[1].accesses_before = accesses_of(decoded.op);
  slots[1].energy_before_fj = energy_fj_[static_cast<std::size_t>(decoded.op)];
  slots[2] = Instruction{};
  return slots.data();
}

void BlockCache::set_longest_wait(std::uint32_t cycles) {
  if (cycles <= longest_wait_) return;
  longest_wait_ = cycles;
  forget();
}

bool BlockCache::delays_first_jump(const Block& block, const Previous& two_before, const Previous& before) const {
  MEBOTS_ASSERT(block.early_jump && block.valid());
  const auto& jump = *instructions(block);
  if (!is_jump(jump.op)) return true;
  const std::uint8_t rd = jump.rd == kNoRegister ? 0 : jump.rd;
  const bool delays = static_cycles(timing_, two_before, before, {jump.op, rd, jump.rs1}) != (&jump)[1].cycles_before;
  MEBOTS_ASSERT(delays || !timing_.hides_unaligned_target(before.op), "what hides its target takes time from it, too");
  return delays;
}

bool BlockCache::end_block_at(std::uint32_t pc) {
  if (memory_.marked(pc, 2, Region::kLoop)) return false;
  memory_.mark(pc, 2, Region::kLoop);
  memory_.invalidate_code(pc, 2);
  return true;
}

void BlockCache::clear() {
  memory_.forget_code();
  forget();
}

void BlockCache::forget() {
  MEBOTS_ASSERT(!blocks_.empty(), "number 0 is not a block");
  code_generation_ = memory_.code_generation();
  std::fill(by_pc_.begin(), by_pc_.end(), 0U);
  std::fill(by_page_.begin(), by_page_.end(), 0U);
  free_.clear();
  for (auto number = static_cast<std::uint32_t>(blocks_.size()); --number > 0;) {
    blocks_[number].pc = Block::kInvalid;
    free_.push_back(number);
  }
  segment_ = 0;
  arena_used_ = 0;
  ++generation_;
  if (listener_ != nullptr) listener_->invalidated_all();
}

}  // namespace mebots::soc
