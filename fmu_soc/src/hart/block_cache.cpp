// SPDX-License-Identifier: Apache-2.0
#include "hart/block_cache.hpp"

#include "hart/hart.hpp"

#include <algorithm>
#include <cstring>

namespace mebots::soc {
namespace {

Current current_of(const Decoded& decoded) {
  return {decoded.op, decoded.rd, decoded.rs1, decoded.rs2, decoded.rs3, decoded.imm};
}

Previous previous_of(const Decoded& decoded) {
  return {decoded.op, decoded.rd, is_multiply_high(decoded.op) || is_divide(decoded.op),
          is_post_increment(decoded.op) ? decoded.rs1 : std::uint8_t{0}};
}

/// Bit r: a load of register r just before the instruction costs it a cycle.
std::uint64_t loads_that_stall(const Timing& timing, const Current& current) {
  std::uint64_t registers = 0;
  const auto alone = static_cycles(timing, {}, {}, current);
  for (std::uint8_t r = 1; r < 32; ++r) {
    if (static_cycles(timing, {}, {Op::lw, r}, current) > alone) registers |= std::uint64_t{1} << r;
  }
  return registers;
}

std::uint8_t accesses_of(Op op) {
  return is_load(op) || is_store(op) ? 1 : 0;
}

}  // namespace

BlockCache::BlockCache(Memory& memory, Timing timing, const InstructionEnergy& energy)
    : memory_(memory),
      timing_(timing),
      energy_fj_(energy.fj),
      blocks_(kMaxBlocks),
      table_(kTableSize),
      arena_(std::make_unique_for_overwrite<Instruction[]>(kArenaSize)) {}

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

Instruction BlockCache::translate(const Decoded& decoded, std::uint32_t pc) const {
  Instruction instruction;
  instruction.run = handler_of(decoded.op, decoded.operand);
  instruction.pc = pc;
  instruction.op = decoded.op;
  instruction.imm = operand_value(decoded);
  if (decoded.op == Op::auipc || decoded.op == Op::jal || is_branch(decoded.op)) {
    instruction.imm = static_cast<std::int32_t>(pc + static_cast<std::uint32_t>(decoded.imm));
  }
  if (decoded.encoding != nullptr && is_store(decoded.op) && has_register_offset(decoded.encoding->format)) {
    instruction.imm = decoded.rs3;
  }
  instruction.rd = decoded.rd == 0 ? 32 : decoded.rd;
  instruction.rs1 = decoded.rs1;
  instruction.rs2 = decoded.rs2;
  return instruction;
}

std::uint32_t BlockCache::decode_block(std::uint32_t pc) {
  std::uint32_t word = 0;
  std::uint32_t fault_address = 0;
  if (!fetch(memory_, pc, word, fault_address)) return 0;
  if (block_count_ == kMaxBlocks || arena_used_ + kMaxBlockLength + 2 > kArenaSize) clear();

  Block block;
  block.pc = pc;
  block.first = arena_used_;
  block.unaligned = (pc & 2U) != 0 && !is_compressed(word);
  Previous two_before;
  Previous before;
  Instruction sums;
  std::uint32_t bound = 0;
  auto at = pc;
  bool loop = false;
  while (sums.index < kMaxBlockLength && fetch(memory_, at, word, fault_address)) {
    const auto decoded = decode_word(word);
    auto& instruction = arena_[arena_used_ + sums.index];
    instruction = translate(decoded, at);
    instruction.cycles_before = sums.cycles_before;
    instruction.index = sums.index;
    instruction.accesses_before = sums.accesses_before;
    instruction.energy_before_fj = sums.energy_before_fj;
    if (sums.index == 0) block.stalled_by = loads_that_stall(timing_, current_of(decoded));
    if (is_jump(decoded.op)) {
      // What the jump's handler cannot see: whether a slow instruction hides an unaligned target.
      instruction.rs2 = before.slow && timing_.multi_cycle_hides_unaligned_target() ? 1 : 0;
      if (sums.index < 2) block.early_jump = true;
    }
    const auto cycles = static_cycles(timing_, two_before, before, current_of(decoded));
    block.last_start_bound = bound;
    // A misaligned access goes twice.
    bound += cycles + most_extra_cycles(decoded.op) + 2 * longest_wait_ * accesses_of(decoded.op);
    sums.cycles_before = static_cast<std::uint16_t>(sums.cycles_before + cycles);
    sums.index = static_cast<std::uint8_t>(sums.index + 1);
    sums.accesses_before = static_cast<std::uint8_t>(sums.accesses_before + accesses_of(decoded.op));
    sums.energy_before_fj += energy_fj_[static_cast<std::size_t>(decoded.op)];
    two_before = before;
    before = previous_of(decoded);
    loop = may_end_loop(at);
    at += decoded.length;
    if (is_branch(decoded.op) && block.front_end == 0) block.front_end = at;
    if (loop || ends_block(decoded.op)) break;
  }
  auto& end = arena_[arena_used_ + sums.index];
  end = sums;
  end.op = loop ? Op::loop_end : Op::end_of_block;
  end.run = handler_of(end.op);
  end.pc = at;
  block.end = at;
  block.entry_bound = fetches() ? kAbsent : block.last_start_bound;
  block.present_end = fetches() ? pc : at;
  if (block.front_end == 0) block.front_end = at;
  block.front_bound = block.last_start_bound;
  if (fetches()) {
    const auto lines_behind = cached_lines_->line_of(at - 1) - cached_lines_->line_of(block.front_end - 1);
    block.front_bound += lines_behind * cached_lines_->refill_cycles();
  }
  arena_[arena_used_ + sums.index + 1] = Instruction{};  // holds the link of a loop's next turn
  memory_.mark(pc, at - pc, Region::kCode);

  arena_used_ += sums.index + 2U;
  const auto number = block_count_++;
  blocks_[number] = block;
  auto slot = hash(pc);
  while (table_[slot] != 0) slot = (slot + 1) & (kTableSize - 1);
  table_[slot] = number;
  return number;
}

const Instruction* BlockCache::single(std::uint32_t pc, const Previous& two_before, const Previous& before) {
  std::uint32_t word = 0;
  std::uint32_t fault_address = 0;
  if (!fetch(memory_, pc, word, fault_address)) return nullptr;
  const auto decoded = decode_word(word);
  single_[0] = translate(decoded, pc);
  if (is_jump(decoded.op)) {
    const bool behind = is_multiply_high(before.op) || is_divide(before.op);
    single_[0].rs2 = behind && timing_.multi_cycle_hides_unaligned_target() ? 1 : 0;
  }
  single_[1] = Instruction{};
  single_[1].op = may_end_loop(pc) ? Op::loop_end : Op::end_of_block;
  single_[1].run = handler_of(single_[1].op);
  single_[1].pc = pc + decoded.length;
  single_[1].index = 1;
  single_[1].cycles_before =
      static_cast<std::uint16_t>(static_cycles(timing_, two_before, before, current_of(decoded)));
  single_[1].accesses_before = accesses_of(decoded.op);
  single_[1].energy_before_fj = energy_fj_[static_cast<std::size_t>(decoded.op)];
  single_[2] = Instruction{};
  return single_.data();
}

void BlockCache::set_longest_wait(std::uint32_t cycles) {
  if (cycles == longest_wait_) return;
  longest_wait_ = cycles;
  forget();
}

void BlockCache::fetch_through(const InstructionCache& cache) {
  cached_lines_ = &cache;
  present_.reserve(kMaxBlocks);
  forget();
}

void BlockCache::look_for(std::uint32_t number) {
  const auto& block = blocks_[number];
  const bool is_known = block.present_end > block.pc;
  auto line = cached_lines_->line_of(block.present_end);
  while (block.present_end < block.end && cached_lines_->holds(line)) {
    block.present_end = std::min(cached_lines_->address_of(++line), block.end);
  }
  if (block.present_end == block.end) block.entry_bound = block.last_start_bound;
  if (!is_known && block.present_end > block.pc) present_.push_back(number);
}

void BlockCache::left(std::uint32_t line) {
  if (line == InstructionCache::kNoLine) return;
  const auto address = cached_lines_->address_of(line);
  std::erase_if(present_, [&](std::uint32_t number) {
    const auto& block = blocks_[number];
    if (block.present_end <= address || line < cached_lines_->line_of(block.pc)) return false;
    block.entry_bound = kAbsent;
    block.present_end = std::max(address, block.pc);
    return block.present_end == block.pc;
  });
}

void BlockCache::left_all() {
  for (const auto number : present_) {
    blocks_[number].entry_bound = kAbsent;
    blocks_[number].present_end = blocks_[number].pc;
  }
  present_.clear();
}

bool BlockCache::end_block_at(std::uint32_t pc) {
  if (memory_.marked(pc, 2, Region::kLoop)) return false;
  memory_.mark(pc, 2, Region::kLoop);
  clear();
  return true;
}

void BlockCache::clear() {
  memory_.forget_code();
  forget();
}

void BlockCache::forget() {
  code_generation_ = memory_.code_generation();
  std::fill(table_.begin(), table_.end(), 0U);
  block_count_ = 1;
  arena_used_ = 0;
  present_.clear();
  ++generation_;
}

}  // namespace mebots::soc
