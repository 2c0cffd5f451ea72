// SPDX-License-Identifier: Apache-2.0
#include "isa/encoding.hpp"

#include "assembler.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cctype>
#include <cstring>
#include <random>
#include <set>
#include <string>
#include <utility>

namespace mebots::soc {
namespace {

std::string full_name(const Encoding& row) {
  return std::string(row.name);
}

/// Returns a core that has the row's extension and all extensions that are compatible with it.
Extensions core_of(const Encoding& row) {
  if (row.extension != Extension::zfinx) return kMostExtensions;
  auto core = Extensions(Extension::zfinx).with(Extension::xpulp).with(Extension::a);
  for (const auto extension : {Extension::zba, Extension::zbb, Extension::zbc, Extension::zbs}) core.add(extension);
  return core;
}

TEST(EncodingTable, HasOneRowPer32BitWord) {
  const auto table = encodings();
  for (std::size_t i = 0; i < table.size(); ++i) {
    EXPECT_EQ(table[i].match & ~table[i].mask, 0U) << table[i].name << ": match has bits outside its mask";
    for (std::size_t j = i + 1; j < table.size(); ++j) {
      if (is_compressed(table[i].format) || is_compressed(table[j].format)) continue;
      if (!core_of(table[i]).has(table[j].extension) || !core_of(table[j]).has(table[i].extension)) continue;
      const auto common = table[i].mask & table[j].mask;
      if ((table[i].match & common) != (table[j].match & common)) continue;
      // A row's encoding may be a special case of another row's encoding if that other row reserves these operands.
      const bool special =
          table[i].mask != common ? is_reserved(table[j], table[i].match) : is_reserved(table[i], table[j].match);
      EXPECT_TRUE(special) << full_name(table[i]) << " overlaps " << full_name(table[j]);
    }
  }
}

TEST(EncodingTable, HasOneRowPerCompressedWord) {
  for (std::uint32_t word = 0; word < 0x10000; ++word) {
    if (!is_compressed(word)) continue;
    int rows = 0;
    for (const auto& row : encodings()) {
      if (is_compressed(row.format) && (word & row.mask) == row.match && !is_reserved(row, word)) ++rows;
    }
    EXPECT_LE(rows, 1) << fmt::format("0x{:04x}", word);
  }
}

/// Every 32-bit word with random operands belongs to at most one row, and decoding must find that row.
TEST(EncodingTable, IsDecodedRowByRow) {
  std::mt19937 random(2);  // NOLINT: the same words each time
  for (const auto& row : encodings()) {
    if (is_compressed(row.format)) continue;
    for (int i = 0; i < 200; ++i) {
      const auto word = (static_cast<std::uint32_t>(random()) & ~row.mask) | row.match;
      if (is_reserved(row, word)) continue;
      int rows = 0;
      for (const auto& other : encodings()) {
        if (!is_compressed(other.format) && core_of(row).has(other.extension) && (word & other.mask) == other.match &&
            !is_reserved(other, word)) {
          ++rows;
        }
      }
      ASSERT_EQ(rows, 1) << full_name(row) << fmt::format(" 0x{:08x}", word);
      ASSERT_EQ(decode(word, core_of(row)).encoding, &row) << full_name(row) << fmt::format(" 0x{:08x}", word);
      const auto standard = decode(word, Extension::standard).encoding;
      ASSERT_EQ(standard, row.extension == Extension::standard ? &row : nullptr) << full_name(row);
    }
  }
}

TEST(EncodingTable, NamesEachRowOnceAndCoversEveryOperation) {
  std::set<std::pair<std::string, Format>> names;  // for example, p.lw is a name of three formats
  std::set<Op> ops;
  for (const auto& row : encodings()) {
    EXPECT_TRUE(names.emplace(full_name(row), row.format).second) << full_name(row);
    ops.insert(row.op);
  }
  EXPECT_EQ(ops.size(), static_cast<std::size_t>(kOpCount) - 3) << "all but illegal, end_of_block, loop_end";
}

/// Makes equal texts from equivalent ones: "addi sp, sp, -16" and "addi sp,sp,-16", "0x10" and "16", "2a <.data+0x2a>"
/// and "0x0000002a".
std::string normal(const std::string& line, bool target_is_hex) {
  auto text = line.substr(0, line.find(" <"));
  text = text.substr(0, text.find(" #"));
  std::vector<std::string> tokens(1);
  for (const char c : text) {
    if (c == ' ' || c == '\t' || c == ',' || c == '(' || c == ')') {
      if (!tokens.back().empty()) tokens.emplace_back();
    } else {
      tokens.back() += c;
    }
  }
  if (tokens.back().empty()) tokens.pop_back();
  for (std::size_t i = 1; i < tokens.size(); ++i) {
    const bool last = i + 1 == tokens.size();
    char* end = nullptr;
    const auto number = std::strtoll(tokens[i].c_str(), &end, last && target_is_hex ? 16 : 0);
    const bool digit =
        std::isdigit(static_cast<unsigned char>(tokens[i][0])) != 0 || tokens[i][0] == '-' || target_is_hex;
    if (*end == '\0' && digit) tokens[i] = std::to_string(number & 0xffffffffLL);
  }
  return fmt::format("{}", fmt::join(tokens, " "));
}

bool has_target(const Decoded& decoded) {
  return decoded.op == Op::jal || is_branch(decoded.op);
}

TEST(Disassembly, AgreesWithBinutilsForEveryCompressedWord) {
  std::vector<std::uint8_t> code;
  std::vector<std::uint32_t> words;
  for (std::uint32_t word = 0; word < 0x10000; ++word) {
    if (!is_compressed(word)) continue;
    words.push_back(word);
    code.push_back(static_cast<std::uint8_t>(word));
    code.push_back(static_cast<std::uint8_t>(word >> 8));
  }
  const auto lines = test::disassemble_with_objdump(code);
  ASSERT_EQ(lines.size(), words.size());
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto decoded = decode(words[i]);
    auto line = lines[i];
    // Not in RV32IMFC: double precision, and words that are no instruction. Binutils also prints shifts by 32 and more,
    // which only exist for 64 bits.
    const bool long_shift =
        line.starts_with("c.s") && line.find(",0x") != std::string::npos && (words[i] & 0x1000U) != 0;
    // The manual reserves this word (table 16.6), although binutils prints a text.
    const bool reserved = line == "c.addi16sp\tsp,0";
    const bool illegal = line.starts_with("c.fld") || line.starts_with("c.fsd") || line.starts_with(".2byte") ||
                         line.starts_with("c.unimp") || long_shift || reserved;
    ASSERT_EQ(decoded.op == Op::illegal, illegal) << fmt::format("0x{:04x}: {}", words[i], line);
    if (illegal) continue;
    // A shift by 0 is a hint in RV32. Binutils prints it with the name that it has in RV128, which ends in 64.
    if (const auto at = line.find("64\t"); at != std::string::npos && line.starts_with("c.s"))
      line = line.replace(at, 2, "") + ",0";
    const auto pc = static_cast<std::uint32_t>(2 * i);
    ASSERT_EQ(normal(disassemble(words[i], pc), has_target(decoded)), normal(line, has_target(decoded)))
        << fmt::format("0x{:04x}", words[i]);
  }
}

TEST(Disassembly, AgreesWithBinutilsForRandomWords) {
  std::mt19937 random(1);  // NOLINT: the same words each time
  std::vector<std::uint32_t> words;
  for (const auto& row : encodings()) {
    // For raw words, binutils disassembles only these extensions.
    const bool is_known =
        row.extension == Extension::standard || row.extension == Extension::a || row.extension == Extension::f;
    if (is_compressed(row.format) || !is_known) continue;
    for (int i = 0; i < 100; ++i) {
      auto word = (static_cast<std::uint32_t>(random()) & ~row.mask) | row.match;
      if (row.format == Format::fence) word &= 0x0ff0707fU;
      if (row.op == Op::fence_i) word = row.match;
      if (is_reserved(row, word)) continue;
      if (is_atomic(row.op)) word &= ~(3U << 25);  // binutils adds aq and rl to the name
      words.push_back(word);
    }
  }
  std::vector<std::uint8_t> code(words.size() * 4);
  std::memcpy(code.data(), words.data(), code.size());
  const auto lines = test::disassemble_with_objdump(code);
  ASSERT_EQ(lines.size(), words.size());
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto decoded = decode(words[i]);
    ASSERT_NE(decoded.op, Op::illegal) << fmt::format("0x{:08x}", words[i]);
    const auto name = lines[i].substr(0, lines[i].find_first_of("\t "));
    ASSERT_EQ(decoded.encoding->name, name);
    if (is_csr(decoded.op) || decoded.encoding->format == Format::fence) continue;  // binutils writes names
    const auto pc = static_cast<std::uint32_t>(4 * i);
    ASSERT_EQ(normal(disassemble(words[i], pc), has_target(decoded)), normal(lines[i], has_target(decoded)));
  }
}

}  // namespace
}  // namespace mebots::soc
