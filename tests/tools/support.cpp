// SPDX-License-Identifier: Apache-2.0
#include "support.hpp"

#include "mebots/error.hpp"

#include <fmt/core.h>

#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <iterator>

namespace mebots::soc::test {

Folder::Folder() {
  auto name = (std::filesystem::temp_directory_path() / "mebots-tools-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw Error("no temporary folder");
  path_ = name;
}

Folder::~Folder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string Folder::program(std::string_view text, std::uint32_t address) const {
  const auto bytes = assemble_file(text, address);
  const auto path = *this / "program.elf";
  write_text(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  return path;
}

Outcome run_tool(const std::string& arguments) {
  const Folder folder;
  const auto out = folder / "out";
  const auto err = folder / "err";
  const auto status =
      std::system(fmt::format("timeout 100 {} {} > {} 2> {}", tool_path(), arguments, out, err).c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_text(out), read_text(err)};
}

std::string tool_path() {
  return "'" MEBOTS_SOC_TOOL "'";
}

std::string read_text(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write_text(const std::string& path, std::string_view text) {
  std::ofstream(path, std::ios::binary) << text;
}

}  // namespace mebots::soc::test
