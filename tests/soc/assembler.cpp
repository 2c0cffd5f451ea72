// SPDX-License-Identifier: Apache-2.0
#include "assembler.hpp"

#include "mebots/error.hpp"
#include "support/files.hpp"

#include <fmt/core.h>

#include <cstdio>
#include <sstream>

namespace mebots::soc::test {
namespace {

std::string output_of(const std::string& command) {
  auto* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) throw Error(fmt::format("cannot run {}", command));
  std::string text;
  char buffer[4096];
  while (const auto count = std::fread(buffer, 1, sizeof buffer, pipe)) text.append(buffer, count);
  if (pclose(pipe) != 0) throw Error(fmt::format("failed: {}\n{}", command, text));
  return text;
}

}  // namespace

std::vector<std::uint8_t> assemble_file(std::string_view text, std::uint32_t address, std::string_view options) {
  const mebots::test::Folder folder("mebots-soc");
  const auto source = folder / "program.S";
  const auto program = folder / "program.elf";
  mebots::test::write_file(source, fmt::format(".globl _start\n{}\n", text));
  output_of(
      fmt::format("{} -march=rv32imc_zicsr_zifencei -mabi=ilp32 -nostdlib -nostartfiles '-I{}' "
                  "-Wl,-n -Wl,-Ttext=0x{:x} -Wl,--no-relax -Wl,--build-id=none {} {} -o {} 2>&1",
                  MEBOTS_RISCV_GCC, MEBOTS_BOARD_INCLUDE, address, options, source.string(), program.string()));
  const auto bytes = mebots::test::read_file(program);
  return {bytes.begin(), bytes.end()};
}

Elf assemble(std::string_view text, std::uint32_t address) {
  return Elf::parse(assemble_file(text, address), "test program");
}

std::vector<std::string> disassemble_with_objdump(const std::vector<std::uint8_t>& code) {
  const mebots::test::Folder folder("mebots-soc");
  const auto path = folder / "code.bin";
  mebots::test::write_file(path, {reinterpret_cast<const char*>(code.data()), code.size()});
  std::string tool = MEBOTS_RISCV_GCC;
  tool.replace(tool.rfind("gcc"), 3, "objdump");
  std::istringstream lines(
      output_of(fmt::format("{} -D -z -b binary -m riscv:rv32 -M no-aliases {}", tool, path.string())));
  std::vector<std::string> found;
  for (std::string line; std::getline(lines, line);) {
    // A line has the form " 2a:\t0001 \tc.addi\tzero,0".
    const auto colon = line.find(":\t");
    if (colon == std::string::npos) continue;
    const auto tab = line.find('\t', colon + 2);
    found.push_back(tab == std::string::npos ? "" : line.substr(tab + 1));
  }
  return found;
}

}  // namespace mebots::soc::test
