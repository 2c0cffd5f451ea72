// SPDX-License-Identifier: Apache-2.0
#include "support.hpp"

#include <fmt/core.h>

#include <sys/wait.h>

#include <cstdlib>

namespace mebots::soc::test {

std::string Folder::program(std::string_view text, std::uint32_t address) const {
  const auto bytes = assemble_file(text, address);
  const auto path = *this / "program.elf";
  write_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  return path;
}

Outcome run_tool(const std::string& arguments) {
  const Folder folder;
  const auto out = folder / "out";
  const auto err = folder / "err";
  const auto status =
      std::system(fmt::format("timeout 100 {} {} > {} 2> {}", tool_path(), arguments, out, err).c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_file(out), read_file(err)};
}

Outcome run_program(std::string_view text, const std::string& options) {
  const Folder folder;
  return run_tool(fmt::format("run {} {}", folder.program(fmt::format("{}\n{}", text, kTohost)), options));
}

std::string tool_path() {
  return "'" MEBOTS_SOC_TOOL "'";
}

}  // namespace mebots::soc::test
