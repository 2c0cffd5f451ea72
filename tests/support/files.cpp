// SPDX-License-Identifier: Apache-2.0
#include "support/files.hpp"

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace mebots::test {

Folder::Folder(std::string_view name) {
  auto pattern = (std::filesystem::temp_directory_path() / (std::string(name) + " XXXXXX")).string();
  if (name.find(' ') == std::string_view::npos) pattern.replace(pattern.size() - 7, 1, "-");
  if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder " + pattern);
  path_ = pattern;
}

Folder::~Folder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string read_file(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void write_file(const std::filesystem::path& file, std::string_view bytes) {
  std::ofstream stream(file, std::ios::binary);
  stream << bytes;
  stream.close();
  if (!stream) throw std::runtime_error("a test file cannot be written: " + file.string());
}

}  // namespace mebots::test
