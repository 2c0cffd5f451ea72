// SPDX-License-Identifier: Apache-2.0
#include "hart/csr_names.hpp"

#include "hart/csr_numbers.hpp"

#include <fmt/core.h>

#include <array>

namespace mebots::soc::csr {
namespace {

constexpr std::array kNamed{
    Named{kMstatus, "mstatus"},
    Named{kMisa, "misa"},
    Named{kMie, "mie"},
    Named{kMtvec, "mtvec"},
    Named{kMcountinhibit, "mcountinhibit"},
    Named{kMscratch, "mscratch"},
    Named{kMepc, "mepc"},
    Named{kMcause, "mcause"},
    Named{kMtval, "mtval"},
    Named{kMip, "mip"},
    Named{kMcycle, "mcycle"},
    Named{kMinstret, "minstret"},
    Named{kMcycleh, "mcycleh"},
    Named{kMinstreth, "minstreth"},
    Named{kCycle, "cycle"},
    Named{kInstret, "instret"},
    Named{kCycleh, "cycleh"},
    Named{kInstreth, "instreth"},
    Named{kMvendorid, "mvendorid"},
    Named{kMarchid, "marchid"},
    Named{kMimpid, "mimpid"},
    Named{kMhartid, "mhartid"},
};

struct Numbered {
  unsigned first;
  std::string_view text;
  std::string_view end;
};

/// 29 of each, counted from 3.
constexpr std::array kNumbered{
    Numbered{kMhpmevent3, "mhpmevent", ""},       Numbered{kMhpmcounter3, "mhpmcounter", ""},
    Numbered{kMhpmcounter3h, "mhpmcounter", "h"}, Numbered{kHpmcounter3, "hpmcounter", ""},
    Numbered{kHpmcounter3h, "hpmcounter", "h"},
};

}  // namespace

std::span<const Named> named() {
  return kNamed;
}

std::string name(unsigned number) {
  for (const auto& entry : kNamed) {
    if (entry.number == number) return std::string(entry.name);
  }
  for (const auto& entry : kNumbered) {
    if (number >= entry.first && number < entry.first + 29) {
      return fmt::format("{}{}{}", entry.text, number - entry.first + 3, entry.end);
    }
  }
  return fmt::format("csr0x{:03x}", number);
}

}  // namespace mebots::soc::csr
