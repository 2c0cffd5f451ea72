// SPDX-License-Identifier: Apache-2.0
#include "translate/translator.hpp"

#include "translate/code_memory.hpp"
#include "translate/emitter.hpp"

#include <xbyak/xbyak_util.h>

#include <algorithm>
#include <bit>

namespace mebots::soc::translate {
namespace {

constexpr std::size_t kCodeBytes = std::size_t{4} << 20;
/// More than any region takes: room that must be left before one is begun.
constexpr std::size_t kMostRegionBytes = std::size_t{256} << 10;

class HostTranslator : public Translator {
 public:
  HostTranslator(const BlockCache& cache, const Execution& execution, const Manner& manner,
                 std::unique_ptr<CodeMemory> memory)
      : cache_(cache), manner_(manner), memory_(std::move(memory)) {
    memories_.ram[0] = execution.ram[0];
    memories_.ram[1] = execution.ram[1];
    entries_.resize(BlockCache::kMaxBlocks);
    Emitter emitter(*memory_, 0, cache_, memories_, manner_, exits_);
    gates_ = emitter.emit_gates();
    gates_size_ = emitter.size();
    used_ = gates_size_;
  }

  bool full() const override { return used_ + kMostRegionBytes > memory_->size(); }

  const Entry& translate(std::uint32_t block) override {
    const auto region = grow_region(cache_, block);
    Emitter emitter(*memory_, used_, cache_, memories_, manner_, exits_);
    const auto entries = emitter.emit(region, allocate(region), gates_);
    for (std::size_t i = 0; i < entries.size(); ++i) {
      auto& entry = entries_[region.nodes[i].number];
      if (entry.plain == nullptr) entry = entries[i];
    }
    used_ += (emitter.size() + 15) / 16 * 16;
    return entries_[block];
  }

  Left run(Execution& execution, const std::uint8_t* code) override {
    struct Return {  // in rax and rdx
      std::uint64_t exit;
      Execution* execution;
    };
    using Enter = Return (*)(Execution*, const std::uint8_t*);
    const auto [exit, stopped] = std::bit_cast<Enter>(gates_.enter)(&execution, code);
    if (exit == Emitter::kNoExit) return {nullptr, stopped};
    last_exit_ = static_cast<std::uint32_t>(exit);
    return {&exits_.exits[last_exit_], stopped};
  }

  void lead_on(std::uint32_t pc, const Entry& entry) override {
    if (last_exit_ == kForgotten) return;
    const auto& exit = exits_.exits[last_exit_];
    if (exit.indirect) {
      if (!exit.straight) exits_.targets.set(pc, entry.jumped);
    } else if (exit.way != nullptr && exit.pc == pc) {
      *exit.way = exit.straight ? entry.straight : exit.jumped ? entry.jumped : entry.plain;
    }
  }

  void forget() override {
    if (used_ == gates_size_) return;
    std::fill(entries_.begin(), entries_.end(), Entry{});
    last_exit_ = kForgotten;
    exits_.exits.clear();
    exits_.ways.clear();
    exits_.targets.clear();
    used_ = gates_size_;
    CodeMemory::serialise();
  }

 private:
  static constexpr auto kForgotten = ~std::uint32_t{0};

  const BlockCache& cache_;
  Execution memories_;  // only these of it
  Manner manner_;
  std::unique_ptr<CodeMemory> memory_;
  Emitter::Gates gates_;
  std::size_t used_ = 0;
  std::size_t gates_size_ = 0;
  Emitter::Exits exits_;
  std::uint32_t last_exit_ = kForgotten;
};

}  // namespace

bool can_translate() {
  using Xbyak::util::Cpu;
  const Cpu cpu;
  return cpu.has(Cpu::tBMI1) && cpu.has(Cpu::tBMI2) && cpu.has(Cpu::tLZCNT) && cpu.has(Cpu::tSSE41) &&
         cpu.has(Cpu::tPOPCNT);
}

std::unique_ptr<Translator> make_translator(const BlockCache& cache, const Execution& execution, const Manner& manner) {
  if (!can_translate()) return nullptr;
  for (const auto& ram : execution.ram) {
    if (ram.base % 4 != 0) return nullptr;
  }
  if (manner.banks != nullptr) {  // whose ticks and banks the code computes
    if (!manner.loose_limit) return nullptr;
    if (execution.ram[0].wait_cycles != 0 || execution.ram[0].base / 4 % manner.banks->count() != 0) return nullptr;
    // No block goes on in the table farther than there is room: a division is the longest, an access can go twice.
    const std::uint64_t longest = kDivideBaseCycles + 32 + 2 * (execution.ram[1].wait_cycles + 1);
    if (BlockCache::kMaxBlockLength * longest > Banks::kLongestBlock) return nullptr;
  }
  auto memory = CodeMemory::create(kCodeBytes);
  if (memory == nullptr) return nullptr;
  return std::make_unique<HostTranslator>(cache, execution, manner, std::move(memory));
}

}  // namespace mebots::soc::translate
