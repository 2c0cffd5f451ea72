// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <charconv>
#include <optional>
#include <string>
#include <string_view>

namespace mebots::master {

/// One cell after the other of a text in CSV. Views the text, which must outlive this object.
class CsvCells {
 public:
  explicit CsvCells(std::string_view text) : text_(text) {}

  bool at_end() const { return at_ >= text_.size(); }
  /// True when the cell that next() gave last was the last of its line.
  bool line_ended() const { return line_ended_; }
  /// The next cell without its quotation marks.
  std::string next() {
    std::string room;
    return std::string(next(room));
  }
  /// The same, without a copy where no mark stands: it views the text, or `room`.
  std::string_view next(std::string& room) {
    std::string_view cell;
    if (at_ < text_.size() && text_[at_] == '"') {
      room.clear();
      for (++at_; at_ < text_.size(); ++at_) {
        if (text_[at_] == '"' && (at_ + 1 >= text_.size() || text_[at_ + 1] != '"')) break;
        if (text_[at_] == '"') ++at_;
        room += text_[at_];
      }
      ++at_;
      cell = room;
    } else {
      auto end = at_;
      while (end < text_.size() && text_[end] != ',' && text_[end] != '\n') ++end;
      cell = text_.substr(at_, end - at_);
      at_ = end;
    }
    line_ended_ = at_ >= text_.size() || text_[at_] == '\n';
    ++at_;  // the comma or the line's end
    return cell;
  }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
  bool line_ended_ = false;
};

/// The number that the whole cell is; nothing for anything else.
template <typename T>
std::optional<T> csv_number(std::string_view text) {
  T value{};
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (result.ec != std::errc{} || result.ptr != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace mebots::master
