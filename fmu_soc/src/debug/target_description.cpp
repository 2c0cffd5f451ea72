// SPDX-License-Identifier: Apache-2.0
#include "debug/target_description.hpp"

#include "hart/csr_names.hpp"
#include "isa/encoding.hpp"

#include <fmt/core.h>

#include <string_view>

namespace mebots::soc::debug {
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
