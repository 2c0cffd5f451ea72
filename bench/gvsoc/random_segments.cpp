// SPDX-License-Identifier: Apache-2.0
// mebots-random-segments SEED COUNT writes random Xpulp programs as assembly text. The text uses the macros of
// random_xpulp.S.
//
// Each segment starts with random registers and the memory of the previous segment. It ends with a record of all
// registers. Four kinds of instructions are known to have other results in GVSoC for some operands. Their operands and
// results are logged, and the result is overwritten, so that later instructions cannot differ.
#include "xpulp/random_xpulp.hpp"

#include "isa/encoding.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string_view>
#include <system_error>

namespace {

using namespace mebots::soc;
using namespace mebots::soc::test;

constexpr std::uint32_t kMiddleOfData = 0x1C060000;  // as in random_xpulp.S
constexpr std::size_t kPieceWords = 24;              // of a segment, before a watched instruction and at its end
constexpr unsigned kWatchedOfSegment = 2;

bool loads_with_step(std::uint32_t word) {
  const auto op = decode(word).op;
  return is_load(op) && is_post_increment(op);
}

bool stores_with_step(std::uint32_t word) {
  const auto op = decode(word).op;
  return is_store(op) && is_post_increment(op);
}

bool stores_its_pointer(std::uint32_t word) {
  return stores_with_step(word) && (word >> 15 & 31U) == (word >> 20 & 31U);
}

bool is_watched(std::uint32_t word) {
  const auto decoded = decode(word);
  if (stores_its_pointer(word)) return true;
  if (loads_with_step(word)) return decoded.rd == decoded.rs1;
  if (decoded.op == Op::p_clip || decoded.op == Op::p_clipu) return decoded.operand == Operand::reg;
  const auto& traits = traits_of(decoded.op);
  return traits.kind == OpKind::multiply_halves && traits.reads_rd && traits.rounds;
}

/// True if GVSoC's open PULP chip does not support the instruction: additional forms of pv.pack in GAP8, and encodings
/// with a set bit that the RTL ignores.
bool is_unknown(std::uint32_t word) {
  const auto name = decode(word).encoding->name;
  const bool with_ignored_bit = (word >> 25 & 1U) != 0 && (name == "pv.pack" || name.starts_with("pv.abs."));
  return with_ignored_bit || name.starts_with("pv.pack.h.");
}

class Author {
 public:
  explicit Author(std::uint64_t seed)
      : random_(seed),
        generator_(random_, false, [](std::uint32_t word) { return is_watched(word) || is_unknown(word); }) {}

  void segment(unsigned number) {
    std::array<std::uint32_t, 32> registers{};
    for (unsigned i = 1; i < 32; ++i) registers[i] = at_start(i);
    fmt::print("    segment 0x{:x}\n", fmt::join(registers, ", 0x"));
    for (unsigned i = 0; i < kWatchedOfSegment; ++i) {
      piece();
      watched();
    }
    piece();
    fmt::print("    end_segment {}\n", number);
  }

 private:
  static bool is_pointer(unsigned index) { return index >= kFirstPointer && index <= kLastPointer; }

  std::uint32_t at_start(unsigned index) {
    if (is_pointer(index)) return kMiddleOfData + random_.below(4096);
    if (index >= kFirstOffset && index <= kLastOffset) return random_.below(64) - 32U;
    return index == kTurns ? random_.below(5) : random_.operand();
  }

  void piece() {
    for (const auto word : generator_.program(kPieceWords)) {
      fmt::print("    .word 0x{:08x}  # {}\n", word, disassemble(word, 0));
    }
  }

  template <typename Wanted>
  std::uint32_t any(Wanted wanted) {
    auto word = generator_.any_row();
    while (!wanted(word)) word = generator_.any_row();
    return word;
  }

  /// Returns an instruction whose operands and result the program logs (is_watched()). In half of the cases, it is a
  /// load that overwrites its own pointer or a store of its own pointer, because random instructions rarely do this.
  std::uint32_t any_watched() {
    switch (random_.below(4)) {
      case 0: {
        const auto word = any(loads_with_step);
        return Generator::with(word, 7, word >> 15 & 31U);
      }
      case 1: {
        const auto word = any(stores_with_step);
        return Generator::with(word, 20, word >> 15 & 31U);
      }
      default:
        return any(is_watched);
    }
  }

  void watched() {
    const auto word = any_watched();
    const bool stores = stores_its_pointer(word);
    const auto rs1 = word >> 15 & 31U;
    const auto changed = stores ? rs1 : word >> 7 & 31U;
    fmt::print("    {} 0x{:08x}, {}, {}, {}, 0x{:x}  # {}\n", stores ? "watch_store" : "watch", word, changed, rs1,
               word >> 20 & 31U, at_start(changed), disassemble(word, 0));
  }

  Random random_;
  Generator generator_;
};

template <typename Number>
std::optional<Number> number(std::string_view text) {
  Number value{};
  const auto* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, value);
  return read.ec == std::errc{} && read.ptr == end ? std::optional{value} : std::nullopt;
}

}  // namespace

int main(int argc, char** argv) {
  const auto seed = argc == 3 ? number<std::uint64_t>(argv[1]) : std::nullopt;
  const auto count = argc == 3 ? number<std::uint32_t>(argv[2]) : std::nullopt;
  if (!seed || !count) {
    fmt::print(stderr,
               "usage: mebots-random-segments SEED COUNT\nboth are whole numbers, SEED below 2^64, COUNT below 2^32\n");
    return 2;
  }
  Author author(*seed);
  for (std::uint32_t i = 0; i < *count; ++i) author.segment(i);
  return 0;
}
