// SPDX-License-Identifier: Apache-2.0
#include "sink/csv_rows.hpp"

#include "base/time.hpp"
#include "mebots/error.hpp"

#include <fmt/format.h>

#include <bit>
#include <charconv>
#include <fstream>
#include <optional>
#include <string>

namespace mebots::master {
namespace {

/// One cell after the other of a text in CSV.
class Cells {
 public:
  explicit Cells(std::string_view text) : text_(text) {}

  bool at_end() const { return at_ >= text_.size(); }
  /// The next cell without its quotation marks.
  std::string next() {
    std::string cell;
    if (at_ < text_.size() && text_[at_] == '"') {
      for (++at_; at_ < text_.size(); ++at_) {
        if (text_[at_] == '"' && (at_ + 1 >= text_.size() || text_[at_ + 1] != '"')) break;
        if (text_[at_] == '"') ++at_;
        cell += text_[at_];
      }
      ++at_;
    } else {
      const auto end = std::min(text_.find_first_of(",\n", at_), text_.size());
      cell = text_.substr(at_, end - at_);
      at_ = end;
    }
    ++at_;  // the comma or the line's end
    return cell;
  }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
};

template <typename T>
std::optional<T> number(const std::string& text) {
  T value{};
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (result.ec != std::errc{} || result.ptr != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

void copy_csv_rows(const std::filesystem::path& file, std::uint64_t bytes, const std::vector<RecordColumn>& columns,
                   RowSink& sink) {
  std::string text(bytes, '\0');
  std::ifstream stream(file, std::ios::binary);
  if (!stream.read(text.data(), static_cast<std::streamsize>(bytes))) {
    throw Error(fmt::format("{}: this file cannot be read", file.string()));
  }
  const auto fail = [&] {
    throw Error(fmt::format("{}: this file does not hold the rows that were written", file.string()));
  };
  Cells cells(text);
  for (std::size_t i = 0; i <= columns.size(); ++i) cells.next();  // the header
  RowBlock block;
  block.cells_per_row = columns.size() + 1;
  while (!cells.at_end()) {
    const auto time_s = number<double>(cells.next());
    const auto time_ns = time_s ? to_nanoseconds(*time_s) : std::nullopt;
    if (!time_ns) fail();
    block.cells.push_back(static_cast<std::uint64_t>(*time_ns));
    for (const auto& column : columns) {
      const auto cell = cells.next();
      if (column.kind == ValueKind::string) {
        block.cells.push_back(block.texts.size());
        block.texts.push_back(cell);
      } else if (column.kind == ValueKind::real) {
        const auto value = number<double>(cell);
        if (!value) fail();
        block.cells.push_back(std::bit_cast<std::uint64_t>(*value));
      } else {
        const auto value = number<std::int64_t>(cell);
        if (!value) fail();
        block.cells.push_back(static_cast<std::uint64_t>(*value));
      }
    }
    if (block.cells.size() < kBlockCells) continue;
    sink.write(block);
    block.clear();
  }
  sink.write(block);
}

}  // namespace mebots::master
