// SPDX-License-Identifier: Apache-2.0
#include "reference.hpp"

#include <algorithm>

namespace mebots::soc::test {
namespace {

std::uint32_t bits_of(std::uint32_t word, unsigned high, unsigned low) {
  return static_cast<std::uint32_t>((std::uint64_t{word} >> low) & ((std::uint64_t{1} << (high - low + 1)) - 1));
}

/// Returns a field of `width` bits as a signed number.
std::int64_t as_signed(std::uint64_t value, unsigned width) {
  value &= (std::uint64_t{1} << width) - 1;
  const auto half = std::uint64_t{1} << (width - 1);
  return value >= half ? static_cast<std::int64_t>(value) - static_cast<std::int64_t>(half) * 2
                       : static_cast<std::int64_t>(value);
}
std::int64_t as_unsigned(std::uint64_t value, unsigned width) {
  return static_cast<std::int64_t>(value & ((std::uint64_t{1} << width) - 1));
}
std::uint32_t word_of(std::int64_t value) {
  return static_cast<std::uint32_t>(static_cast<std::uint64_t>(value));
}

/// Returns the largest integer not above value / 2^shift.
std::int64_t floor_shift(std::int64_t value, unsigned shift) {
  const auto divisor = std::int64_t{1} << shift;
  auto quotient = value / divisor;
  if (value % divisor < 0) --quotient;
  return quotient;
}

}  // namespace

bool XpulpReference::step(std::uint32_t word) {
  auto next_pc = pc + 4;
  if (!execute(word, next_pc)) return false;
  x[0] = 0;
  if (next_pc == pc + 4) {
    // Handles the end of a loop's body. The inner loop is checked first. A loop without remaining iterations is
    // ignored.
    for (auto& one : loops) {
      if (pc != one.end || one.count < 2) continue;
      one.count -= 1;
      next_pc = one.start;
      break;
    }
  }
  pc = next_pc;
  return true;
}

bool XpulpReference::execute(std::uint32_t word, std::uint32_t& next_pc) {
  switch (bits_of(word, 6, 0)) {
    case 0x03:
      return load(word, false);
    case 0x0b:
      return load(word, true);
    case 0x23:
      return bits_of(word, 14, 12) >= 4 && store(word, false);
    case 0x2b:
      return store(word, true);
    case 0x33:
      return bits_of(word, 31, 31) == 1 ? bits(word) : alu(word);
    case 0x57:
      return simd(word);
    case 0x5b:
      return shifted(word);
    case 0x63: {
      const auto kind = bits_of(word, 14, 12);
      if (kind != 2 && kind != 3) return false;
      const auto distance = bits_of(word, 31, 31) * 4096U + bits_of(word, 7, 7) * 2048U + bits_of(word, 30, 25) * 32U +
                            bits_of(word, 11, 8) * 2U;
      const bool equal = as_signed(x[bits_of(word, 19, 15)], 32) == as_signed(bits_of(word, 24, 20), 5);
      if (equal == (kind == 2)) next_pc = pc + word_of(as_signed(distance, 13));
      return true;
    }
    case 0x7b:
      return loop(word);
    default:
      return false;
  }
}

std::optional<std::int64_t> XpulpReference::read(std::uint32_t address, unsigned bytes, bool sign) const {
  const auto offset = std::int64_t{address} - std::int64_t{ram_base};
  if (offset < 0 || offset + bytes > static_cast<std::int64_t>(ram.size())) return std::nullopt;
  std::uint64_t value = 0;
  for (unsigned i = 0; i < bytes; ++i) value += std::uint64_t{ram[static_cast<std::size_t>(offset) + i]} << (8 * i);
  return sign ? as_signed(value, 8 * bytes) : as_unsigned(value, 8 * bytes);
}

bool XpulpReference::write(std::uint32_t address, unsigned bytes, std::uint32_t value) {
  const auto offset = std::int64_t{address} - std::int64_t{ram_base};
  if (offset < 0 || offset + bytes > static_cast<std::int64_t>(ram.size())) return false;
  written_from = std::min(written_from, static_cast<std::uint32_t>(offset));
  written_to = std::max(written_to, static_cast<std::uint32_t>(offset) + bytes);
  for (unsigned i = 0; i < bytes; ++i) {
    ram[static_cast<std::size_t>(offset) + i] = static_cast<std::uint8_t>(bits_of(value, 8 * i + 7, 8 * i));
  }
  return true;
}

bool XpulpReference::load(std::uint32_t word, bool post) {
  const auto kind = bits_of(word, 14, 12);
  const auto base = x[bits_of(word, 19, 15)];
  std::uint32_t step = word_of(as_signed(bits_of(word, 31, 20), 12));
  unsigned bytes = 0;
  bool sign = true;
  if (kind == 7) {
    step = x[bits_of(word, 24, 20)];
    switch (bits_of(word, 31, 25)) {
      case 0b0000000:
        bytes = 1;
        break;
      case 0b0001000:
        bytes = 2;
        break;
      case 0b0010000:
        bytes = 4;
        break;
      case 0b0100000:
        bytes = 1;
        sign = false;
        break;
      case 0b0101000:
        bytes = 2;
        sign = false;
        break;
      default:
        return false;
    }
  } else if (post) {
    if (kind == 3 || kind == 6) return false;
    bytes = kind % 4 == 0 ? 1 : kind % 4 == 1 ? 2 : 4;
    sign = kind < 4;
  } else {
    if (kind != 6) return false;  // p.elw; the other words belong to the base instruction set
    bytes = 4;
  }
  const auto address = post ? base : base + step;
  const auto value = read(address, bytes, sign);
  if (!value) return false;
  if (post) x[bits_of(word, 19, 15)] = base + step;
  x[0] = 0;
  x[bits_of(word, 11, 7)] = word_of(*value);
  return true;
}

bool XpulpReference::store(std::uint32_t word, bool post) {
  const auto kind = bits_of(word, 14, 12);
  const auto base = x[bits_of(word, 19, 15)];
  const bool by_register = kind >= 4;
  if (kind % 4 == 3 || (by_register && bits_of(word, 31, 25) != 0)) return false;
  const auto step = by_register ? x[bits_of(word, 11, 7)]
                                : word_of(as_signed(bits_of(word, 31, 25) * 32U + bits_of(word, 11, 7), 12));
  const auto address = post ? base : base + step;
  if (!write(address, 1U << (kind % 4), x[bits_of(word, 24, 20)])) return false;
  if (post) x[bits_of(word, 19, 15)] = base + step;
  return true;
}

bool XpulpReference::alu(std::uint32_t word) {
  const auto kind = bits_of(word, 14, 12);
  const auto field2 = bits_of(word, 24, 20);
  auto& d = x[bits_of(word, 11, 7)];
  const auto a = x[bits_of(word, 19, 15)];
  const auto b = x[field2];
  const auto sa = as_signed(a, 32);
  const auto sb = as_signed(b, 32);
  switch (bits_of(word, 31, 25)) {
    case 0b0000010:
      switch (kind) {
        case 0:
          if (field2 != 0) return false;
          d = word_of(sa < 0 ? -sa : sa);
          return true;
        case 1:
          return false;
        case 2:
          d = sa <= sb;
          return true;
        case 3:
          d = a <= b;
          return true;
        case 4:
          d = word_of(std::min(sa, sb));
          return true;
        case 5:
          d = std::min(a, b);
          return true;
        case 6:
          d = word_of(std::max(sa, sb));
          return true;
        default:
          d = std::max(a, b);
          return true;
      }
    case 0b0000100: {
      if (kind != 5) return false;
      auto value = a;
      for (unsigned i = 0; i < b % 32; ++i) value = (value >> 1) + (value % 2 == 1 ? 0x80000000U : 0U);
      d = value;
      return true;
    }
    case 0b0001000: {
      if (field2 != 0) return false;
      std::uint32_t result = 32;
      switch (kind) {
        case 0:
          for (unsigned i = 32; i-- > 0;) {
            if (bits_of(a, i, i) == 1) result = i;
          }
          break;
        case 1:
          for (unsigned i = 0; i < 32; ++i) {
            if (bits_of(a, i, i) == 1) result = i;
          }
          break;
        case 2:  // number of bits directly below the sign that equal it
          result = 0;
          if (a != 0) {
            while (result < 31 && bits_of(a, 30 - result, 30 - result) == bits_of(a, 31, 31)) ++result;
          }
          break;
        case 3:
          result = 0;
          for (unsigned i = 0; i < 32; ++i) result += bits_of(a, i, i);
          break;
        case 4:
          result = word_of(as_signed(a, 16));
          break;
        case 5:
          result = bits_of(a, 15, 0);
          break;
        case 6:
          result = word_of(as_signed(a, 8));
          break;
        default:
          result = bits_of(a, 7, 0);
          break;
      }
      d = result;
      return true;
    }
    case 0b0001010: {
      // Forms with an immediate n have the bound 2^(n-1) - 1, or 0 for n = 0.
      const auto bound = kind == 1 || kind == 2 ? (field2 == 0 ? 0 : (std::int64_t{1} << (field2 - 1)) - 1) : sb;
      if (kind == 1 || kind == 5) {
        d = word_of(sa > bound ? bound : sa < -bound - 1 ? -bound - 1 : sa);
      } else if (kind == 2 || kind == 6) {
        d = word_of(sa > bound ? bound : sa < 0 ? 0 : sa);
      } else {
        return false;
      }
      return true;
    }
    case 0b0100001:
      if (kind > 1) return false;
      d = word_of(
          static_cast<std::int64_t>(std::uint64_t{d} + (kind == 0 ? 1 : -1) * static_cast<std::uint64_t>(sa * sb)));
      return true;
    default:
      return false;
  }
}

/// Executes an instruction of bit manipulation on `width` bits from bit `first` on.
bool XpulpReference::bits(std::uint32_t word) {
  const auto kind = bits_of(word, 14, 12);
  if (kind > 4) return false;
  auto& d = x[bits_of(word, 11, 7)];
  const auto a = x[bits_of(word, 19, 15)];
  auto width = bits_of(word, 29, 25) + 1;
  auto first = bits_of(word, 24, 20);
  if (bits_of(word, 30, 30) == 0) {
    if (width != 1) return false;
    width = bits_of(x[first], 9, 5) + 1;
    first = bits_of(x[bits_of(word, 24, 20)], 4, 0);
  }
  std::uint32_t result = kind == 2 ? d : kind < 2 ? 0 : a;
  for (unsigned i = 0; i < 32; ++i) {
    const auto mask = std::uint32_t{1} << i;
    switch (kind) {
      case 0:
      case 1: {
        // The bits of the result after the field are copies of the field's last bit (signed), or zeros. If the field
        // reaches beyond the word, its bits there are copies of the word's sign, or zeros.
        const auto from = std::min(i, kind == 0 ? width - 1 : i) + first;
        const bool inside = i < width || kind == 0;
        const auto bit = from < 32 ? bits_of(a, from, from) : kind == 0 ? bits_of(a, 31, 31) : 0;
        if (inside && bit == 1) result |= mask;
        break;
      }
      case 2:
        if (i >= first && i < first + width) result = (result & ~mask) | (bits_of(a, i - first, i - first) << i);
        break;
      case 3:
        if (i >= first && i < first + width) result &= ~mask;
        break;
      default:
        if (i >= first && i < first + width) result |= mask;
        break;
    }
  }
  d = result;
  return true;
}

/// Executes an addition or multiplication with a shift, which may round.
bool XpulpReference::shifted(std::uint32_t word) {
  const auto kind = bits_of(word, 13, 12);
  const bool rounds = bits_of(word, 14, 14) == 1;
  auto& d = x[bits_of(word, 11, 7)];
  const auto a = x[bits_of(word, 19, 15)];
  const auto b = x[bits_of(word, 24, 20)];
  auto shift = bits_of(word, 29, 25);
  const bool top = bits_of(word, 31, 31) == 1;
  const bool second = bits_of(word, 30, 30) == 1;
  bool is_signed = top;
  std::int64_t sum = 0;
  if (kind < 2) {
    const auto low = second ? 16U : 0U;
    const auto half_a = bits_of(a, low + 15, low);
    const auto half_b = bits_of(b, low + 15, low);
    sum = is_signed ? as_signed(half_a, 16) * as_signed(half_b, 16) : as_unsigned(half_a, 16) * as_unsigned(half_b, 16);
    if (kind == 1) sum += d;
  } else {
    is_signed = !top;
    auto first_operand = std::int64_t{a};
    auto second_operand = std::int64_t{b};
    if (second) {
      if (shift != 0) return false;
      first_operand = d;
      second_operand = a;
      shift = b % 32;
    }
    sum = kind == 2 ? first_operand + second_operand : first_operand - second_operand;
  }
  if (rounds && shift > 0) sum += std::int64_t{1} << (shift - 1);
  const auto wrapped = static_cast<std::uint64_t>(sum);
  d = word_of(floor_shift(is_signed ? as_signed(wrapped, 32) : as_unsigned(wrapped, 32), shift));
  return true;
}

bool XpulpReference::loop(std::uint32_t word) {
  const auto kind = bits_of(word, 14, 12);
  if (kind > 5 || bits_of(word, 11, 8) != 0) return false;
  auto& one = loops[bits_of(word, 7, 7)];
  const auto immediate = bits_of(word, 31, 20);
  const auto a = x[bits_of(word, 19, 15)];
  if (kind == 0) one.start = pc + 2 * immediate;
  if (kind == 1 || kind == 4) one.end = pc + 2 * immediate;
  if (kind == 5) one.end = pc + 2 * bits_of(word, 19, 15);
  if (kind == 2 || kind == 4) one.count = a;
  if (kind == 3 || kind == 5) one.count = immediate;
  if (kind >= 4) one.start = pc + 4;
  return true;
}

bool XpulpReference::simd(std::uint32_t word) {
  const auto form = bits_of(word, 14, 12);
  if (form == 2 || form == 3) return false;
  const bool bytes = form % 2 == 1;
  const unsigned width = bytes ? 8 : 16;
  const unsigned count = 32 / width;
  const auto code = bits_of(word, 31, 27);
  const bool compares = bits_of(word, 26, 26) == 1;
  const auto field2 = bits_of(word, 24, 20);
  const auto six = field2 * 2 + bits_of(word, 25, 25);
  auto& d = x[bits_of(word, 11, 7)];
  const auto a = x[bits_of(word, 19, 15)];
  const auto rs2 = x[field2];
  const bool vector = form < 2;
  const bool immediate = form >= 6;

  const auto part = [&](std::uint32_t value, unsigned index, bool sign) {
    const auto field = bits_of(value, index * width + width - 1, index * width);
    return sign ? as_signed(field, width) : as_unsigned(field, width);
  };
  // Returns the second operand of part i. Unsigned operations have an unsigned immediate.
  const auto second = [&](unsigned index, bool sign, bool unsigned_immediate) -> std::int64_t {
    if (!immediate) return part(rs2, vector ? index : 0, sign);
    const auto value = unsigned_immediate ? as_unsigned(six, 6) : as_signed(six, 6);
    return sign ? as_signed(static_cast<std::uint64_t>(value), width)
                : as_unsigned(static_cast<std::uint64_t>(value), width);
  };
  std::uint32_t result = 0;
  const auto put = [&](unsigned index, std::int64_t value) {
    result |= word_of(as_unsigned(static_cast<std::uint64_t>(value), width)) << (index * width);
  };

  if (compares) {
    if (code > 9) return false;
    const bool is_unsigned = code >= 6;
    for (unsigned i = 0; i < count; ++i) {
      const auto p = part(a, i, !is_unsigned);
      const auto q = second(i, !is_unsigned, is_unsigned);
      const std::array<bool, 10> holds{p == q, p != q, p > q, p >= q, p<q, p <= q, p> q, p >= q, p < q, p <= q};
      put(i, holds[code] ? -1 : 0);
    }
    d = result;
    return true;
  }
  switch (code) {
    case 0:
    case 1:
    case 2:
    case 3:
    case 4:
    case 5:
    case 6:
    case 7:
    case 8:
    case 9:
    case 10:
    case 11:
    case 12:
    case 13:
      for (unsigned i = 0; i < count; ++i) {
        const bool is_unsigned = code == 3 || code == 5 || code == 7 || code == 8 || code == 10;
        const auto p = part(a, i, !is_unsigned);
        const auto q = second(i, !is_unsigned, is_unsigned);
        const auto amount = static_cast<unsigned>(static_cast<std::uint64_t>(q) % width);
        switch (code) {
          case 0:
            put(i, p + q);
            break;
          case 1:
            put(i, p - q);
            break;
          case 2:
            put(i, floor_shift(as_signed(static_cast<std::uint64_t>(p + q), width), 1));
            break;
          case 3:
            put(i, floor_shift(as_unsigned(static_cast<std::uint64_t>(p + q), width), 1));
            break;
          case 4:
          case 5:
            put(i, std::min(p, q));
            break;
          case 6:
          case 7:
            put(i, std::max(p, q));
            break;
          case 8:
          case 9:
            put(i, floor_shift(p, amount));
            break;
          case 10:
            put(i, p * (std::int64_t{1} << amount));
            break;
          case 11:
            put(i, p | q);
            break;
          case 12:
            put(i, p ^ q);
            break;
          default:
            put(i, p & q);
            break;
        }
      }
      break;
    case 14:
      if (!vector) return false;  // as in the RTL, which decodes bits 31 to 26 only, and accepts any rs2
      for (unsigned i = 0; i < count; ++i) put(i, std::max(part(a, i, true), -part(a, i, true)));
      break;
    case 15:
    case 18:
      if (!immediate) return false;
      result = word_of(part(a, six % count, code == 15));
      break;
    case 16:
    case 17:
    case 19:
    case 20:
    case 21:
    case 23: {
      const bool sums = code >= 20;
      const auto signs = code - (sums ? 20 : 16);  // signed operands: 0: none, 1: the second, 3: both
      auto sum = sums ? std::int64_t{d} : 0;
      for (unsigned i = 0; i < count; ++i) sum += part(a, i, signs == 3) * second(i, signs != 0, signs == 0);
      result = word_of(sum);
      break;
    }
    case 22:
      if (!immediate) return false;
      for (unsigned i = 0; i < count; ++i) put(i, part(i == six % count ? a : d, i == six % count ? 0 : i, false));
      break;
    case 24:
    case 29:
    case 30:
    case 31:
      if (form == 4 || form == 5 || (code != 24 && form != 7)) return false;
      for (unsigned i = 0; i < count; ++i) {
        std::uint32_t from = 0;
        if (vector) {
          from = static_cast<std::uint32_t>(part(rs2, i, false)) % count;
        } else if (bytes) {
          from = i == 3 ? (code == 24 ? 0 : code - 28) : bits_of(six, 2 * i + 1, 2 * i);
        } else {
          from = bits_of(six, i, i);
        }
        put(i, part(a, from, false));
      }
      break;
    case 25:
      if (!vector) return false;
      for (unsigned i = 0; i < count; ++i) {
        const auto from = static_cast<std::uint32_t>(part(rs2, i, false)) % (2 * count);
        put(i, part(from < count ? d : a, from % count, false));
      }
      break;
    case 26: {  // GAP8's two additional forms: low halves, high halves
      if (bytes) return false;
      const auto half = form == 6 ? 1U : 0U;
      put(0, part(rs2, half, false));
      put(1, part(a, half, false));
      break;
    }
    case 27:
    case 28: {
      if (form != 1) return false;
      const auto low = code == 27 ? 2U : 0U;
      for (unsigned i = 0; i < 4; ++i) put(i, part(d, i, false));
      result &= ~(0xffffU << (8 * low));
      put(low, part(rs2, 0, false));
      put(low + 1, part(a, 0, false));
      break;
    }
    default:
      return false;
  }
  d = result;
  return true;
}

}  // namespace mebots::soc::test
