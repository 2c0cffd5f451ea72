// SPDX-License-Identifier: Apache-2.0
#include "content.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace mebots::data {
namespace {

constexpr std::size_t kTextBlock = 256;  // bytes; about a line of most files

/// Returns the number of characters whose first byte is in this piece of UTF-8.
std::size_t characters_in(std::string_view piece) {
  return static_cast<std::size_t>(std::count_if(
      piece.begin(), piece.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

}  // namespace

TextLines::TextLines(std::string text) : text_(std::move(text)) {
  for (std::size_t at = text_.find('\n'); at != std::string::npos; at = text_.find('\n', at + 1)) {
    starts_.push_back(at + 1);
  }
  std::size_t characters = 0;
  for (std::size_t at = 0; at <= text_.size(); at += kTextBlock) {
    characters_.push_back(characters);
    characters += characters_in(std::string_view(text_).substr(at, kTextBlock));
  }
}

std::size_t TextLines::characters_before(std::size_t offset) const {
  const auto block = offset / kTextBlock;
  const auto start = block * kTextBlock;
  return characters_[block] + characters_in(std::string_view(text_).substr(start, offset - start));
}

std::string TextLines::place(std::size_t offset) const {
  offset = std::min(offset, text_.size());
  const auto next = std::upper_bound(starts_.begin(), starts_.end(), offset);
  const auto line = static_cast<std::size_t>(next - starts_.begin());
  const auto start = starts_[line - 1];
  const auto column = offset - start < kTextBlock ? characters_in(std::string_view(text_).substr(start, offset - start))
                                                  : characters_before(offset) - characters_before(start);
  return fmt::format(":{}:{}", line, column + 1);
}

}  // namespace mebots::data
