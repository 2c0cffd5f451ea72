// SPDX-License-Identifier: Apache-2.0
#include "isa/extension.hpp"

#include "mebots/error.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <vector>

namespace mebots::soc {
namespace {

struct Named {
  std::string_view name;
  Extension extension;
};

/// Optional extensions of a core, in the order of an ISA string.
constexpr auto kOptions = std::to_array<Named>({
    {"a", Extension::a},
    {"f", Extension::f},
    {"u", Extension::user},
    {"zfinx", Extension::zfinx},
    {"zba", Extension::zba},
    {"zbb", Extension::zbb},
    {"zbc", Extension::zbc},
    {"zbs", Extension::zbs},
});

/// Parts of RV32IMC, which every core has.
constexpr auto kAlways = std::to_array<std::string_view>({"i", "m", "c", "zicsr", "zifencei", "zmmul", "zca"});
constexpr std::string_view kThere = "there are a, f, u, zfinx, zba, zbb, zbc and zbs";

struct Absent {
  std::string_view name;
  std::string_view why;
};
constexpr auto kAbsent = std::to_array<Absent>({
    {"d", "the cores have no double precision: use f, and compile with -mabi=ilp32f"},
    {"g", "this is imafd, and the cores have no d: write imaf"},
    {"e", "the cores have 32 registers; use i in place of e"},
    {"s", "the cores have no supervisor mode: use u, and physical memory protection"},
    {"q", "the cores have no quad precision: use f"},
    {"v", "the cores have no vectors"},
    {"h", "the cores have no hypervisor"},
    {"p", "the cores have no packed SIMD of the standard; ri5cy has that of Xpulp"},
    {"zdinx", "the cores have no double precision: use zfinx"},
});

[[noreturn]] void fail(std::string_view text, std::string_view what) {
  throw Error(ErrorCode::invalid_value, fmt::format("the instruction set \"{}\": {}", text, what));
}

/// Splits "rv32imac_zba" into "i", "m", "a", "c" and "zba". Omits versions, such as "2p1" in "i2p1".
std::vector<std::string> parts_of(std::string_view text, std::string_view rest) {
  std::vector<std::string> parts;
  bool in_name = false;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const auto letter = static_cast<char>(std::tolower(static_cast<unsigned char>(rest[i])));
    const bool is_digit = letter >= '0' && letter <= '9';
    if (letter == '_') {
      in_name = false;
    } else if (is_digit || (letter == 'p' && i > 0 && std::isdigit(static_cast<unsigned char>(rest[i - 1])) != 0)) {
      if (parts.empty()) fail(text, "a letter must follow rv32");
    } else if (letter < 'a' || letter > 'z') {
      fail(text, fmt::format("'{}' is not a letter", rest[i]));
    } else if (in_name) {
      parts.back() += letter;
    } else {
      parts.emplace_back(1, letter);
      in_name = letter == 'z' || letter == 's' || letter == 'x';
    }
  }
  return parts;
}

void add_part(Extensions& extensions, std::string_view text, std::string_view part) {
  if (std::ranges::find(kAlways, part) != kAlways.end()) return;
  if (part == "b") {
    for (const auto extension : {Extension::zba, Extension::zbb, Extension::zbs}) extensions.add(extension);
    return;
  }
  if (const auto extension = optional_extension(part); extension != Extension::standard) {
    extensions.add(extension);
    return;
  }
  const auto absent = std::ranges::find(kAbsent, part, &Absent::name);
  if (absent != kAbsent.end()) fail(text, fmt::format("'{}': {}", part, absent->why));
  fail(text, fmt::format("no core has '{}'; {}", part, kThere));
}

}  // namespace

Extension optional_extension(std::string_view name) {
  const auto same = [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
  };
  for (const auto& option : kOptions) {
    if (std::ranges::equal(option.name, name, same)) return option.extension;
  }
  return Extension::standard;
}

Extensions read_isa(std::string_view text) {
  if (text.starts_with("rv64") || text.starts_with("RV64")) fail(text, "the cores have 32 bits: write rv32");
  if (!text.starts_with("rv32") && !text.starts_with("RV32")) fail(text, "it must begin with rv32imc");
  const auto parts = parts_of(text, text.substr(4));
  Extensions extensions;
  for (const auto& part : parts) add_part(extensions, text, part);
  for (const std::string_view needed : {"i", "m", "c"}) {
    if (std::ranges::find(parts, needed) == parts.end()) {
      fail(text, fmt::format("'{}' is missing: every core has it, so write rv32imc, followed by the further extensions",
                             needed));
    }
  }
  if (extensions.has(Extension::f) && extensions.has(Extension::zfinx)) {
    fail(text, "zfinx and f exclude each other: use only one of them");
  }
  return extensions;
}

std::string isa_string(Extensions extensions) {
  std::string text = "rv32im";
  std::string names;
  for (const auto& [name, extension] : kOptions) {
    if (!extensions.has(extension)) continue;
    if (name.size() == 1 && extension != Extension::user) text += name;
    if (name.size() > 1) names += fmt::format("_{}", name);
  }
  text += 'c';
  if (extensions.has(Extension::user)) text += 'u';
  return text + "_zicsr_zifencei" + names;
}

}  // namespace mebots::soc
