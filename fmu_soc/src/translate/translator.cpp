// SPDX-License-Identifier: Apache-2.0
#include "translate/translator.hpp"

#include "mebots/assert.hpp"
#include "translate/assembler.hpp"
#include "translate/code_memory.hpp"
#include "translate/exit_table.hpp"

#include <xbyak/xbyak_util.h>

#include <algorithm>

namespace mebots::soc::translate {
namespace {

/// Upper bounds for the size of a region. This much space must be free before a region is translated.
constexpr std::size_t kMostRegionBytes = std::size_t{256} << 10;
constexpr std::size_t kMostRegionPatchPoints = 4096;

const Xbyak::util::Cpu kProcessor;

class HostTranslator : public Translator {
 public:
  HostTranslator(const BlockCache& blocks, const Execution& execution, const Options& options,
                 std::unique_ptr<CodeMemory> memory)
      : blocks_(blocks), options_(options), memory_(std::move(memory)), exits_(*memory_) {
    memories_.ram[0] = execution.ram[0];
    memories_.ram[1] = execution.ram[1];
    entries_.reserve(BlockCache::kMaxBlocks);
    Assembler assembler(context_, 0, {});
    stubs_ = emit_stubs(assembler);
    begin_segment(0);
  }

  const Entry& translate(std::uint32_t block) override {
    MEBOTS_ASSERT(find(block) == nullptr && blocks_.block(block).valid());
    make_room();
    const auto region = grow_region(blocks_, block, [this](auto number) { return find(number) != nullptr; });
    for (const auto& node : region.nodes) {
      if (entries_.size() <= node.number) entries_.resize(std::max<std::size_t>(2 * entries_.size(), node.number + 1));
    }
    const auto number = new_region();
    auto& made = regions_[number];
    made.segment = segment_;
    const auto first_exit = exits_.count();
    made.begin = memory_->executable(memory_->writable() + used_);
    Assembler assembler(context_, used_, stubs_);
    const auto entries = emit_region(assembler, region);
    used_ += align_up(assembler.getSize());
    MEBOTS_ASSERT(entries.size() == region.nodes.size());
    MEBOTS_ASSERT(used_ <= Segments::begin_of(segment_ + 1), "make_room() left enough");
    made.end = memory_->executable(memory_->writable() + used_);
    for (std::size_t i = 0; i < entries.size(); ++i) {
      const auto& node = region.nodes[i];
      entries_[node.number] = entries[i];
      entries_[node.number].region = number;
      made.blocks.push_back({node.number, node.block->pc});
      translated_ += node.end()->index;
    }
    // The exits of the new region jump directly to the next blocks that already have code.
    for (auto exit = first_exit; exit < exits_.count(); ++exit) chain_where_known(exits_.exit_in_work(exit));
    return entries_[block];
  }

  RunEnd run(Execution& execution, const std::uint8_t* code) override {
    MEBOTS_ASSERT(code != nullptr);
    struct Return {  // in rax and rdx
      std::uint64_t exit;
      Execution* execution;
    };
    // Translated code uses the System V ABI on all systems.
    using Enter = Return(__attribute__((sysv_abi))*)(Execution*, const std::uint8_t*);
    const auto enter =
        reinterpret_cast<Enter>(const_cast<std::uint8_t*>(stubs_.prologue));  // functions are never const
    const auto [exit, stopped] = enter(&execution, code);
    if (exit == kNoExit) return {nullptr, stopped};
    last_exit_ = static_cast<std::uint32_t>(exit);
    return {&exits_.exit(last_exit_), stopped};
  }

  const Exit& exit(std::uint64_t number) const override { return exits_.exit(static_cast<std::uint32_t>(number)); }

  void chain_last_exit(const Block& block, const Entry& entry, bool stalled) override {
    if (last_exit_ == kNone) return;
    const auto& exit = exits_.exit(last_exit_);
    if (stalled && !exit.straight) return;
    if (exit.indirect) {
      if (!exit.straight) exits_.targets.set(block.pc, entry.jumped, entry.plain);
    } else if (exit.patch_point != 0 && exit.pc == block.pc) {
      if (exit.straight && delays_jump(blocks_, block, exit.at)) return;
      chain(exit, entry, stalled);
    }
  }

  void invalidated(std::uint32_t block) override {
    if (find(block) != nullptr) drop(entries_[block].region);
  }

  void invalidated_all() override {
    for (std::uint32_t number = 1; number < regions_.size(); ++number) drop(number);
  }

  std::uint64_t times_dropped() const override { return times_dropped_; }
  std::uint64_t translated() const override { return translated_; }

 private:
  static constexpr auto kNone = ~std::uint32_t{0};

  struct TranslatedRegion {
    struct RegionBlock {
      std::uint32_t number;
      std::uint32_t pc;
    };
    std::uint32_t segment = 0;
    const std::uint8_t* begin = nullptr;  // start of its code; null = dropped
    const std::uint8_t* end = nullptr;
    std::vector<RegionBlock> blocks;
    std::vector<std::uint32_t> patched_to;  // patch points that lead to the region's code, or have led to it
  };

  /// Makes a patch point of a region jump to the code of another region, without a return to the caller (block
  /// chaining).
  void chain(const Exit& exit, const Entry& entry, bool stalled) {
    MEBOTS_ASSERT(exit.patch_point != 0 && entry.plain != nullptr);
    MEBOTS_ASSERT(!stalled || exit.straight, "a jump leaves no load before it");
    exits_.patch(exit.patch_point, stalled         ? entry.stalled
                                   : exit.straight ? entry.straight
                                   : exit.jumped   ? entry.jumped
                                                   : entry.plain);
    regions_[entry.region].patched_to.push_back(exit.patch_point);
  }

  void chain_where_known(const Exit& exit) {
    if (exit.patch_point == 0) return;
    const bool iterates = exit.straight && exit.pc != exit.at->pc;
    const auto number = linked(blocks_, iterates ? exit.at[1].link : exit.at->link, exit.pc);
    if (number == 0 || find(number) == nullptr) return;
    const auto& block = blocks_.block(number);
    if (exit.straight && delays_jump(blocks_, block, exit.at)) return;
    chain(exit, entries_[number], exit.straight && stalls(block, exit.at));
  }

  static std::size_t align_up(std::size_t bytes) { return (bytes + 15) / 16 * 16; }

  std::uint32_t new_region() {
    if (free_regions_.empty()) {
      regions_.emplace_back();
      return static_cast<std::uint32_t>(regions_.size() - 1);
    }
    const auto number = free_regions_.back();
    free_regions_.pop_back();
    return number;
  }

  /// Drops a region, so that no jump leads to its code. The code stays in memory until its segment is filled again,
  /// because the last run may have ended at an exit of this region.
  void drop(std::uint32_t number) {
    MEBOTS_ASSERT(number != 0 && number < regions_.size());
    auto& region = regions_[number];
    if (region.begin == nullptr) return;
    for (const auto& block : region.blocks) {
      entries_[block.number] = {};
      exits_.targets.forget(block.pc);
    }
    for (const auto patch_point : region.patched_to) {
      if (exits_.target_of(patch_point) >= region.begin && exits_.target_of(patch_point) < region.end) {
        exits_.unpatch(patch_point);
      }
    }
    region.blocks.clear();
    region.patched_to.clear();
    region.begin = nullptr;
    free_regions_.push_back(number);
    ++times_dropped_;
  }

  void begin_segment(std::uint32_t segment) {
    segment_ = segment;
    used_ = Segments::begin_of(segment) + Segments::kPatchPointBytes;
    exits_.begin_segment(segment);
  }

  /// Frees space for one more region. If the present segment is full, drops the regions of the next segment.
  void make_room() {
    if (used_ + kMostRegionBytes <= Segments::begin_of(segment_ + 1) &&
        exits_.free_patch_points() >= kMostRegionPatchPoints)
      return;
    const auto next = (segment_ + 1) % Segments::kCount;
    for (std::uint32_t number = 1; number < regions_.size(); ++number) {
      if (regions_[number].begin == nullptr || regions_[number].segment != next) continue;
      drop(number);
    }
    if (exits_.was_used(next)) CodeMemory::serialise();
    last_exit_ = kNone;
    begin_segment(next);
  }

  const BlockCache& blocks_;
  Execution memories_;  // only its memories are used
  Options options_;
  std::unique_ptr<CodeMemory> memory_;
  Stubs stubs_;
  std::uint32_t segment_ = 0;  // the segment that is being filled
  std::size_t used_ = 0;       // offset of the next region
  ExitTable exits_;
  const TranslationContext context_{*memory_, blocks_, memories_.ram, options_, exits_};
  std::vector<TranslatedRegion> regions_{1};  // number 0 is not used
  std::vector<std::uint32_t> free_regions_;
  std::uint32_t last_exit_ = kNone;
  std::uint64_t times_dropped_ = 0;
  std::uint64_t translated_ = 0;
};

}  // namespace

const Xbyak::util::Cpu& host_processor() {
  return kProcessor;
}

bool can_translate() {
  using Xbyak::util::Cpu;
  const Cpu& cpu = host_processor();
  return cpu.has(Cpu::tBMI1) && cpu.has(Cpu::tBMI2) && cpu.has(Cpu::tLZCNT) && cpu.has(Cpu::tSSE41) &&
         cpu.has(Cpu::tPOPCNT);
}

std::unique_ptr<Translator> make_translator(const BlockCache& blocks, const Execution& execution,
                                            const Options& options) {
  if (!can_translate()) return nullptr;
  for (const auto& ram : execution.ram) {
    if (ram.base % 4 != 0) return nullptr;
  }
  if (options.banks != nullptr) {  // translated code counts ticks by rows of the bank table, and claims banks
    if (!options.loose_limit) return nullptr;
    if (execution.ram[0].wait_cycles != 0 || execution.ram[0].base / 4 % options.banks->count() != 0) return nullptr;
    // Checks that no block can run beyond the end of the bank table. The longest instruction is a division. A load or
    // store can take two bus accesses.
    const auto& far = execution.ram[1];
    const std::uint64_t far_wait =
        far.is_shared() ? 0U : far.wait_cycles;  // if shared, wait_for_far() checks the table itself
    const std::uint64_t longest = kDivideBaseCycles + 32 + 2 * (far_wait + 1);
    if (BlockCache::kMaxBlockLength * longest > Banks::kLongestBlock) return nullptr;
  }
  auto memory = CodeMemory::create(Segments::all_bytes());
  if (memory == nullptr) return nullptr;
  return std::make_unique<HostTranslator>(blocks, execution, options, std::move(memory));
}

}  // namespace mebots::soc::translate
