// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/block_cache.hpp"
#include "translate/xbyak.hpp"

#include <cstdint>

namespace mebots::soc::translate {

class Assembler;

class FetchWriter {
 public:
  explicit FetchWriter(Assembler& assembler) : a_(assembler) {}

  /// Returns true if translated code refills the cache. If cores share the cache, the interpreter refills it instead.
  bool are_inline() const;
  /// Writes code that fetches the absent cache lines of `at`, except for a line that also contains the previous
  /// instruction `before`.
  void emit(const Block& block, const Instruction* at, const Instruction* before);
  /// Writes a jump to `absent` that is taken if the cache line of `address` is absent. The code may change rdx.
  void jump_when_absent(std::uint32_t address, Xbyak::Label& absent);

 private:
  void compare_presence(std::uint32_t address);
  void emit_line(std::uint32_t line, std::uint32_t address, bool often_absent);
  void emit_refill(std::uint32_t line, std::uint32_t address);

  Assembler& a_;
};

}  // namespace mebots::soc::translate
