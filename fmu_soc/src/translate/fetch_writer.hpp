// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/block_cache.hpp"
#include "translate/xbyak.hpp"

#include <cstdint>
#include <unordered_map>

namespace mebots::soc::translate {

class Assembler;

class FetchWriter {
 public:
  explicit FetchWriter(Assembler& assembler) : a_(assembler) {}

  /// Returns true if translated code refills the cache. If cores share the cache, the interpreter refills it instead.
  bool are_inline() const;
  /// Writes the code that fetches the absent cache lines of the instruction `at`. Must be called for all instructions
  /// of a block, in their order. The code may also fetch lines of later instructions together with these lines (a
  /// group), if the results stay the same.
  void emit(const Block& block, const Instruction* at);
  /// Writes the code that fetches the absent cache lines of the block's first instruction only.
  void emit_first(const Block& block, const Instruction* first);
  /// Writes code that undoes the refills of lines that were fetched together with earlier lines, but that only
  /// instructions after `at` need. This is necessary if execution leaves the block before `at`, or if `at` uses the
  /// number of cycles. The code changes rcx and rdx.
  void undo_after(const Instruction* at);
  /// Writes code that fetches the lines again that undo_after() has removed. The code changes rax, rcx and rdx.
  void repeat_after(const Instruction* at);
  /// Writes code after which undo_after() has no effect until the next group is fetched. This is necessary if a block
  /// ends without a retired instruction. The code changes rax.
  void forget_group();
  /// Writes a jump to `absent` that is taken if the line of this address is absent. The written code may change rdx.
  void jump_when_absent(std::uint32_t address, Xbyak::Label& absent);

 private:
  /// Consecutive lines that are fetched together.
  struct Group {
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };
  struct LaterLines {
    Group group;
    std::uint32_t bits = 0;  // bit i is set for line i of the group
  };

  static std::uint32_t bits_of(const Group& group) { return (std::uint32_t{1} << group.count) - 1; }
  Group group_from(const Block& block, std::uint32_t line, const Instruction* at) const;
  void note_later_lines(const Group& group, const Instruction* at);
  void emit_shared(const Instruction* at);
  void emit_group(const Group& group, bool often_absent);
  void jump_on_presence(const Group& group, bool present, const Xbyak::Label& target);
  void emit_refill(const Group& group, std::uint32_t bits);
  Xbyak::RegExp place_of(const std::uint8_t* presence);

  Assembler& a_;
  std::uint64_t fetched_end_ = 0;  // the line after the last line that the present block fetches
  /// For each instruction: the lines of its group that only later instructions need.
  std::unordered_map<const Instruction*, LaterLines> later_lines_;
};

}  // namespace mebots::soc::translate
