// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/assert.hpp"
#include "translate/region.hpp"
#include "translate/translator.hpp"
#include "translate/xbyak.hpp"

#include <bit>
#include <cstdint>
#include <vector>

namespace mebots::soc::translate {

class Assembler;

/// Writes the code for the edges of a region's graph: from an entry to a block, from block to block, and from a block
/// to an exit. After a jump, the pipeline is empty. After a fall-through, the last instructions of a block may delay
/// the next block. The code of the edge counts this delay. HostState::straight_pipeline then contains the state of the
/// pipeline.
class EdgeWriter {
 public:
  explicit EdgeWriter(Assembler& assembler) : a_(assembler) {}

  void begin(const Region& region);
  /// Must be called before the code of a node is written.
  void begin_node(std::size_t index);
  /// Returns the block whose code is being written.
  const Block& block() const { return *present_->block; }
  /// Writes the code at the addresses in Entry, through which execution enters the node's block. If `runs_into_node` is
  /// true, the caller must write the node's code directly afterwards. Otherwise the entries end with a jump to the
  /// node's code.
  Entry emit_entry(const Node& node, bool runs_into_node);
  /// Writes the code that all exits of the region share.
  void emit_exits();

  // The following functions write the code with which execution leaves the block at the instruction `at`.

  /// Writes the edges of a branch. `jump_to(label)` must write a jump to the label that is taken if the branch is
  /// taken.
  template <typename Jump>
  void branch(const Instruction* at, Jump jump_to);
  void jump(const Instruction* at, std::uint32_t pc, bool jumped);
  /// Writes a jump from an ecall to its handler at `pc`. The instructions before the ecall must have been counted.
  void enter_handler(const Instruction* at, std::uint32_t pc);
  /// Writes a jump to the address in eax, from jalr or mret.
  void jump_indirect(const Instruction* at);
  /// Writes the code that continues after the end of a block with the block at `pc`. `is_last` must be true if no other
  /// code of the node follows.
  void fall_through(const Instruction* at, std::uint32_t link, std::uint32_t pc, bool is_last);
  /// Writes a jump to the start of a hardware loop.
  void iterate(const Instruction* at, unsigned loop);
  /// Writes an exit before `at`. The interpreter then finishes the block.
  void resume(const Instruction* at);
  void leave_by(const Exit& exit);

 private:
  /// Returns the state of a pipeline in the form of HostState::straight_pipeline.
  static std::uint64_t bits_of(const Pipeline& pipeline) { return std::bit_cast<std::uint64_t>(pipeline); }
  const Node* straight_successor(const Instruction* at, std::uint32_t link) const;
  void fall_through_to(const Instruction* at, const Node& node, bool is_last);
  void save_pipeline_state(const Instruction* end);
  void clear_pipeline_state();
  void check_limit(const Node& node, std::uint32_t stall, const Exit& at_limit);
  void check_limit(const Node& node);
  const Node* node_at(std::uint32_t link, std::uint32_t pc) const;
  void park(const Node& node, const Exit& exit, std::uint32_t stall);
  void park_at_entry(const Node& node, const Exit& exit, std::uint32_t stall);
  void store_next_block(const Node& node);
  void load_next_point();
  void leave_chained(Exit exit);
  std::uint32_t add_exit(const Exit& exit);
  std::size_t index_of(const Node& node) const {
    MEBOTS_ASSERT(&node >= region_->nodes.data() && &node <= &region_->nodes.back());
    return static_cast<std::size_t>(&node - region_->nodes.data());
  }
  Xbyak::Label& label_of(const Node& node) { return labels_[index_of(node)]; }

  Assembler& a_;
  const Region* region_ = nullptr;
  std::vector<Xbyak::Label> labels_;
  const Node* present_ = nullptr;              // node whose code is being written
  const Node* following_ = nullptr;            // node whose code is written next
  std::vector<Xbyak::Label> entries_;          // plain entries
  std::vector<Xbyak::Label> stalled_entries_;  // entries with a stall
  Xbyak::Label leave_all_;                     // stores the registers and leaves through exit eax
  Xbyak::Label perform_all_;                   // stores the registers and executes the rare instruction after exit eax
  Xbyak::Label park_all_;                      // stores the registers and jumps to Stubs::park
};

}  // namespace mebots::soc::translate
