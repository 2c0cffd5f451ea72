// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "isa/encoding.hpp"
#include "runs/hart.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

/// Generates random Xpulp programs, and defines a hart that runs them.
namespace mebots::soc::test {

inline constexpr std::uint32_t kXpulpRam = 0x80000000;
inline constexpr std::uint32_t kXpulpRamBytes = 4U << 20;  // larger than the range of post-increments in one program
inline constexpr std::uint32_t kXpulpSmall = 0x20000000;   // address of a second memory that random programs do not use
inline constexpr std::uint32_t kXpulpSmallBytes = 4096;
inline constexpr std::uint32_t kMiddle = kXpulpRam + kXpulpRamBytes / 2;  // initial value of pointers
inline constexpr std::uint32_t kLeave = 0xfe002e23;  // sw zero, -4(zero): stores to a device, which ends the run
inline constexpr unsigned kFirstPointer = 10;        // x10 to x13: pointers
inline constexpr unsigned kLastPointer = 13;
inline constexpr unsigned kFirstOffset = 14;  // x14, x15: small numbers
inline constexpr unsigned kLastOffset = 15;
inline constexpr unsigned kTurns = 16;       // x16: small numbers >= 0
inline constexpr unsigned kFirstSpare = 17;  // x17, x18: programs do not use them
inline constexpr unsigned kLastSpare = 18;

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  std::uint32_t word() { return static_cast<std::uint32_t>(engine_()); }
  std::uint32_t below(std::uint32_t count) { return word() % count; }
  /// Returns a random number, or a special value.
  std::uint32_t operand() {
    constexpr std::array<std::uint32_t, 12> kCorners{0,          1,          0xffffffff, 0x80000000, 0x7fffffff, 0x8000,
                                                     0x80007fff, 0x7fff8000, 0x80808080, 0x7f7f7f7f, 0x00ff00ff, 31};
    switch (below(8)) {
      case 0:
        return kCorners[below(kCorners.size())];
      case 1:
        return word() & 0x3ffU;
      case 2:
        return 0U - (word() & 0xffU);
      default:
        return word();
    }
  }

 private:
  std::mt19937_64 engine_;
};

/// Generates instruction words from the rows of the encoding table, with operands that keep accesses inside the RAM.
class Generator {
 public:
  /// With `mostly_dots`, half of the instructions are dot products. Other instructions seldom use their registers.
  /// Programs contain no word for which `left_out` returns true.
  explicit Generator(Random& random, bool mostly_dots = false, std::function<bool(std::uint32_t)> left_out = {})
      : random_(random), mostly_dots_(mostly_dots), left_out_(std::move(left_out)) {
    for (const auto& row : encodings()) {
      if (mostly_dots && computes_in_32_bits(row)) standard_.push_back(&row);
      if (row.extension != Extension::xpulp || is_hardware_loop(row.op) || is_branch(row.op)) continue;
      (is_load(row.op) || is_store(row.op) ? accesses_ : computing_).push_back(&row);
      if (is_dot_product(row.op)) dots_.push_back(&row);
    }
  }

  /// Returns an instruction without a jump.
  std::uint32_t plain() {
    for (;;) {
      const auto word = any_plain();
      if (decode(word).op == Op::illegal) continue;  // with this register, the word is another instruction
      if (!left_out_ || !left_out_(word)) return word;
    }
  }

  /// Returns an instruction without a jump. Does not apply `left_out_`; plain() does.
  std::uint32_t any_plain() {
    if (mostly_dots_ && random_.below(2) == 0) {
      const auto& row = *dots_[random_.below(static_cast<std::uint32_t>(dots_.size()))];
      auto word = (random_.word() & ~row.mask) | row.match;
      word = with(word, 7, dot_register());
      for (const auto place : {15U, 20U}) {
        word = with(word, place, random_.below(2) == 0 ? address_register() : dot_register());
      }
      return word;
    }
    auto word = any_row();
    if (!mostly_dots_ || is_store(decode(word).op)) return word;
    // Operands of dot products are mostly written by loads. Other instructions rarely read or write these registers.
    if (random_.below(8) != 0) {
      word = off_dots(off_dots(word, 15), 20);
    } else if (!is_load(decode(word).op)) {
      const auto first = dot_register();
      word = with(with(word, 15, first), 20, dot_register());
      return with(word, 7, random_.below(2) == 0 ? first : dot_register());
    }
    const bool feeds = random_.below(is_load(decode(word).op) ? 2 : 8) == 0;
    return with(word, 7, feeds ? dot_register() : free_register() % 8);
  }

  std::uint32_t any_row() {
    const bool access = random_.below(4) == 0;
    const bool standard = !access && mostly_dots_ && random_.below(3) == 0;
    const auto& rows = access ? accesses_ : standard ? standard_ : computing_;
    const auto& row = *rows[random_.below(static_cast<std::uint32_t>(rows.size()))];
    for (;;) {
      auto word = (random_.word() & ~row.mask) | row.match;
      if (access) {
        word = with(word, 15, kFirstPointer + random_.below(kLastPointer - kFirstPointer + 1));
        const auto offset = kFirstOffset + random_.below(kLastOffset - kFirstOffset + 1);
        const bool by_register = has_step_register(traits_of(row.op).mode);
        if (is_store(row.op) && by_register) word = with(word, 7, offset);
        if (is_load(row.op) && by_register) word = with(word, 20, offset);
        if (is_load(row.op)) word = with(word, 7, free_register());
      } else {
        word = with(word, 7, free_register());
      }
      if (!is_reserved(row, word)) return word;
    }
  }

  std::vector<std::uint32_t> program(std::size_t length) {
    std::vector<std::uint32_t> words;
    while (words.size() < length) {
      switch (random_.below(16)) {
        case 0:
          branch(words);
          break;
        case 1:
          loop(words, random_.below(2), false);
          break;
        case 2:
          loop(words, 1, true);
          break;
        default:
          words.push_back(plain());
          break;
      }
    }
    words.push_back(plain());
    return words;
  }

  /// Returns true for standard arithmetic instructions of 32 bits, without jumps and accesses to memory or CSRs.
  static bool computes_in_32_bits(const Encoding& row) {
    return row.extension == Extension::standard && (row.match & 3U) == 3 && !ends_block(row.op) && !is_load(row.op) &&
           !is_store(row.op) && !is_branch(row.op) && !is_csr(row.op);
  }

  /// Returns the word with `value` in the register field at bit `low`.
  static std::uint32_t with(std::uint32_t word, unsigned low, std::uint32_t value) {
    return (word & ~(31U << low)) | value << low;
  }

 private:
  static constexpr std::uint32_t kFirstDot = 24;  // x24 to x31 are for dot products
  std::uint32_t dot_register() { return kFirstDot + random_.below(32 - kFirstDot); }
  /// Returns a register of a pointer or of an offset.
  std::uint32_t address_register() { return kFirstPointer + random_.below(kLastOffset - kFirstPointer + 1); }
  /// If a register in this field is used by dot products, returns the word with another register in its place.
  static std::uint32_t off_dots(std::uint32_t word, unsigned low) {
    return (word >> low & 31U) >= kFirstDot ? with(word, low, (word >> low & 31U) - 8) : word;
  }
  /// Returns a register that contains neither an address nor a count, so that a random value in it does no harm.
  std::uint32_t free_register() {
    for (;;) {
      const auto index = random_.below(32);
      if (index < kFirstPointer || index > kLastSpare) return index;
    }
  }

  void branch(std::vector<std::uint32_t>& words) {
    const auto skipped = random_.below(3);
    const auto distance = 4 * (skipped + 1);
    const auto registers = mostly_dots_ && random_.below(4) != 0 ? kFirstDot : 32U;
    const auto kind = mostly_dots_ ? random_.below(8) : 2U + random_.below(2);  // kinds 2 and 3 are Xpulp's
    words.push_back(0x63U | kind << 12 | random_.below(registers) << 15 | random_.below(32) << 20 |
                    (distance >> 1 & 15U) << 8 | (distance >> 5) << 25);
    for (std::uint32_t i = 0; i < skipped; ++i) words.push_back(plain());
  }

  void loop(std::vector<std::uint32_t>& words, std::uint32_t number, bool nested) {
    std::vector<std::uint32_t> body;
    const auto before = random_.below(3);
    for (std::uint32_t i = 0; i < before; ++i) body.push_back(plain());
    if (nested) loop(body, 0, false);
    const auto after = 1 + random_.below(4);
    for (std::uint32_t i = 0; i < after; ++i) body.push_back(plain());

    const auto size = static_cast<std::uint32_t>(body.size());
    const auto lp = [&](std::uint32_t kind, std::uint32_t rs1, std::uint32_t immediate) {
      words.push_back(0x7bU | kind << 12 | number << 7 | rs1 << 15 | immediate << 20);
    };
    const auto turns = random_.below(5);
    switch (random_.below(3)) {
      case 0:
        lp(4, kTurns, 2 * size);
        break;
      case 1:
        if (2 * size < 32) {
          lp(5, 2 * size, turns);
          break;
        }
        [[fallthrough]];
      default:
        // Sets up the loop with three instructions: start, count and end of the body. The end is set first or last.
        if (random_.below(2) == 0) {
          lp(0, 0, 6);
          lp(3, 0, turns);
          lp(1, 0, 2 * size);
        } else {
          lp(1, 0, 4 + 2 * size);
          lp(0, 0, 4);
          lp(2, kTurns, 0);
        }
        break;
    }
    words.insert(words.end(), body.begin(), body.end());
  }

  Random& random_;
  bool mostly_dots_;
  std::function<bool(std::uint32_t)> left_out_;
  std::vector<const Encoding*> computing_;
  std::vector<const Encoding*> standard_;
  std::vector<const Encoding*> accesses_;
  std::vector<const Encoding*> dots_;
};

/// A hart whose run ends at a store to an address without memory.
class Platform : public Bus {
 public:
  explicit Platform(bool translate = true)
      : memory_(make_memory()),
        code_(memory_, {.timing = {CoreKind::ri5cy}, .translate = translate}),
        hart_(memory_, *this, code_) {
    hart_.reset(kXpulpRam);
  }
  Hart& hart() { return hart_; }
  Memory& memory() { return memory_; }
  std::uint8_t* ram() { return memory_.regions()[0].data.get(); }
  std::uint8_t* small() { return memory_.regions()[1].data.get(); }

  BusReply load(std::uint32_t, std::uint64_t) override { return {}; }
  BusReply store(std::uint32_t, std::uint64_t, std::uint32_t) override { return BusReply::done(); }
  bool watched(std::uint32_t) override { return false; }

 private:
  static Memory make_memory() {
    Memory memory;
    memory.add("ram", kXpulpRam, kXpulpRamBytes);
    memory.add("small", kXpulpSmall, kXpulpSmallBytes);
    return memory;
  }
  Memory memory_;
  DecodedCode code_;
  Hart hart_;
};

inline std::string listing(const std::vector<std::uint32_t>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto pc = kXpulpRam + 4 * static_cast<std::uint32_t>(i);
    text += fmt::format("  {:08x} {:08x} {}\n", pc, words[i], disassemble(words[i], pc));
  }
  return text;
}

}  // namespace mebots::soc::test
