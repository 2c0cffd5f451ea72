// SPDX-License-Identifier: Apache-2.0
#include "debug/target.hpp"

#include "hart/csr_numbers.hpp"
#include "isa/encoding.hpp"

#include <fmt/core.h>

#include <string_view>

namespace mebots::soc::debug {

std::optional<unsigned> Threads::parse(std::string_view text) const {
  if (text == "-1" || text == "0") return chosen_;
  const auto thread = parse_hex(text);
  return thread && *thread - 1 < soc_.harts() ? std::optional<unsigned>(*thread - 1) : std::nullopt;
}

std::string Threads::list() const {
  std::string text;
  for (unsigned number = 0; number < soc_.harts(); ++number) {
    text += fmt::format("{}{:x}", text.empty() ? 'm' : ',', number + 1);
  }
  return text;
}

std::string Threads::describe(unsigned number) const {
  const auto name =
      number == kFabricControllerHart ? "fabric controller" : fmt::format("cluster core {}", core_of_hart(number));
  if (!soc_.is_on(number)) return name + ", off";
  return std::as_const(soc_).hart(number).sleeping() ? name + ", asleep" : name;
}

namespace {

std::string_view kind_of(unsigned index) {
  if (index == 1) return "code_ptr";
  return index >= 2 && index <= 4 ? "data_ptr" : "int";
}

}  // namespace

std::string target_description() {
  std::string text =
      "<?xml version=\"1.0\"?>\n<!DOCTYPE target SYSTEM \"gdb-target.dtd\">\n<target version=\"1.0\">\n"
      "<architecture>riscv:rv32</architecture>\n<feature name=\"org.gnu.gdb.riscv.cpu\">\n";
  for (unsigned i = 0; i < 32; ++i) {
    text +=
        fmt::format("<reg name=\"{}\" bitsize=\"32\" regnum=\"{}\" type=\"{}\"/>\n", register_name(i), i, kind_of(i));
  }
  text += fmt::format("<reg name=\"pc\" bitsize=\"32\" regnum=\"{}\" type=\"code_ptr\"/>\n</feature>\n", kPcNumber);
  text += "<feature name=\"org.gnu.gdb.riscv.csr\">\n";
  for (const auto& csr : csr::named()) {
    text += fmt::format("<reg name=\"{}\" bitsize=\"32\" regnum=\"{}\" type=\"int\" group=\"csr\"/>\n", csr.name,
                        kFirstCsrNumber + csr.number);
  }
  return text + "</feature>\n</target>\n";
}

}  // namespace mebots::soc::debug
