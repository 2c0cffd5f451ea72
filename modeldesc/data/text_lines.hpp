// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace mebots::data {

/// Where the lines of a text start, to turn an offset into line and column; fast also where all is one long line.
class TextLines {
 public:
  TextLines() : TextLines(std::string()) {}
  explicit TextLines(std::string text);

  /// ":line:column", both from 1; columns count characters of UTF-8.
  std::string place(std::size_t offset) const;

 private:
  std::size_t characters_before(std::size_t offset) const;

  std::string text_;
  std::vector<std::size_t> starts_{0};
  std::vector<std::size_t> characters_;  // of UTF-8 before each block of the text
};

}  // namespace mebots::data
