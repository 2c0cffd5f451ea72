// SPDX-License-Identifier: Apache-2.0
#include "headers.hpp"

#include "board/board_file.hpp"
#include "devices/core/described_device.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <sstream>
#include <string>

namespace mebots::boardgen {

using soc::BoardDescription;

std::string c_header(const BoardDescription& board) {
  std::ostringstream out;
  out << "// SPDX-License-Identifier: Apache-2.0\n"
      << "// Made from the board description \"" << board.name << "\" by mebots-boardgen. Do not edit.\n"
      << "// " << board.text << "\n"
      << "//\n"
      << "// DEVICE_BASE, DEVICE_INTERRUPT, DEVICE_REGISTER_OFFSET are numbers that assembly code can use, too;\n"
      << "// DEVICE_REGISTER is the register itself, to read or write as a 32-bit variable.\n"
      << "#pragma once\n\n"
      << "#ifndef __ASSEMBLER__\n#include <stdint.h>\n#endif\n\n";
  for (const auto& memory : board.memories) {
    const auto name = macro_case(memory.name);
    out << fmt::format("// {}\n#define {}_BASE 0x{:08X}\n#define {}_SIZE {}\n\n", memory.text, name, memory.base, name,
                       memory.size);
  }
  for (const auto& device : board.devices) {
    if (!device.is_on_bus()) continue;
    const auto name = macro_case(device.name);
    out << fmt::format("// {}\n#define {}_BASE 0x{:08X}\n", device.text, name, device.base);
    if (device.interrupt >= 0) out << fmt::format("#define {}_INTERRUPT {}\n", name, device.interrupt);
    for (const auto& reg : device.registers) {
      out << fmt::format("#define {}_{}_OFFSET 0x{:X}  // {}: {}\n", name, macro_case(reg.name), reg.offset, reg.access,
                         reg.text);
    }
    for (const auto& opcode : device.opcodes) {
      out << fmt::format("#define {}_OPCODE_{} {}  // into {}: {}\n", name, macro_case(opcode.name), opcode.value,
                         opcode.register_name, opcode.text);
    }
    // The device sets these bits in a register that shows `status`. A C++ model of the device must use the same bits.
    if (std::ranges::any_of(device.registers, [](const auto& reg) { return reg.shows == "status"; })) {
      using Described = soc::DescribedDevice;
      out << fmt::format("#define {0}_STATUS_BUSY {1}\n#define {0}_STATUS_READY {2}\n#define {0}_STATUS_REFUSED {3}\n",
                         name, Described::kBusy, Described::kReady, Described::kRefused);
    }
    out << "#ifndef __ASSEMBLER__\n";
    for (const auto& reg : device.registers) {
      out << fmt::format("#define {0}_{1} (*({2}volatile uint32_t*)({0}_BASE + {0}_{1}_OFFSET))\n", name,
                         macro_case(reg.name), reg.access == "r" ? "const " : "");
    }
    for (const auto& enumeration : device.enumerations) {
      out << fmt::format("enum {} {{\n", enumeration.name);
      for (const auto& item : enumeration.items) {
        out << fmt::format("  {}_{} = {},\n", macro_case(enumeration.name), macro_case(item.name), item.value);
      }
      out << "};\n";
    }
    out << "#endif\n";
    for (const auto& state : device.states) {
      if (state.delay_s > 0) {
        out << fmt::format("#define {}_{}_DELAY_NS {:.0f}  // {}\n", name, macro_case(state.name), state.delay_s * 1e9,
                           state.text);
      }
    }
    out << "\n";
  }
  return out.str();
}

std::string cpp_header(const BoardDescription& board) {
  std::ostringstream out;
  out << "// SPDX-License-Identifier: Apache-2.0\n"
      << "// Made from the board description \"" << board.name << "\" by mebots-boardgen. Do not edit.\n"
      << "#pragma once\n\n#include <array>\n#include <cstdint>\n#include <string_view>\n\n"
      << "/// " << board.text << ".\n"
      << "namespace mebots::soc::board {\n\n"
      << "/// A register as the board file names it; the file read at start must agree.\n"
      << "struct RegisterName {\n  std::string_view name;\n  std::uint32_t offset;\n};\n\n";
  for (const auto& memory : board.memories) {
    out << fmt::format("/// {}.\nnamespace {} {{\n", memory.text, memory.name);
    out << fmt::format("inline constexpr std::uint32_t kBase = 0x{:08X};\n", memory.base);
    out << fmt::format("inline constexpr std::uint32_t kSize = {};\n}}\n\n", memory.size);
  }
  for (const auto& device : board.devices) {
    if (!device.is_on_bus()) continue;
    out << fmt::format("/// {}.\nnamespace {} {{\n", device.text, device.name);
    out << fmt::format("inline constexpr std::uint32_t kBase = 0x{:08X};\n", device.base);
    if (device.interrupt >= 0) out << fmt::format("inline constexpr int kInterrupt = {};\n", device.interrupt);
    for (const auto& reg : device.registers) {
      out << fmt::format("/// {}: {}.\ninline constexpr std::uint32_t k{} = 0x{:X};\n", reg.access, reg.text,
                         camel_case(reg.name), reg.offset);
    }
    out << fmt::format("inline constexpr std::array<RegisterName, {}> kRegisters{{{{\n", device.registers.size());
    for (const auto& reg : device.registers)
      out << fmt::format("    {{\"{}\", k{}}},\n", reg.name, camel_case(reg.name));
    out << "}};\n";
    for (const auto& enumeration : device.enumerations) {
      out << fmt::format("enum class {} : std::int32_t {{\n", enumeration.name);
      for (const auto& item : enumeration.items) out << fmt::format("  {} = {},\n", item.name, item.value);
      out << "};\n";
    }
    out << "}\n\n";
  }
  out << "}  // namespace mebots::soc::board\n";
  return out.str();
}

}  // namespace mebots::boardgen
