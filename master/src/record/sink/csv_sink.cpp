// SPDX-License-Identifier: Apache-2.0
#include "record/sink/csv_sink.hpp"

#include "mebots/data/csv.hpp"
#include "mebots/error.hpp"

#include <fmt/format.h>

#include <bit>
#include <charconv>
#include <cstring>
#include <fstream>
#include <string>

namespace mebots::master {

std::string csv_text(std::string_view text) {
  if (text.find_first_of(",\"\n\r") == std::string_view::npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

std::string csv_header(std::string_view name, std::string_view unit) {
  return csv_text(fmt::format("{} [{}]", name, unit.empty() ? "-" : unit));
}

CsvSink::CsvSink(const std::vector<RecordColumn>& columns, OutputFile& file) : file_(&file) {
  std::string header = "time [s]";
  for (const auto& column : columns) {
    columns_.push_back({column.kind, 0, 0, {}});
    header += ',' + csv_header(column.name, column.unit);
  }
  line_.resize((columns.size() + 1) * (kLongestNumber + 1));
  if (file_->size() == 0) file_->append(header + '\n');
}

char* CsvSink::write_number(char* at, Column& column, std::uint64_t cell) {
  if (column.last_size == 0 || cell != column.last) {
    char* const first = column.last_text.data();
    char* const end = first + column.last_text.size();
    const auto result = column.kind == ValueKind::real ? std::to_chars(first, end, std::bit_cast<double>(cell))
                                                       : std::to_chars(first, end, static_cast<std::int64_t>(cell));
    column.last = cell;
    column.last_size = static_cast<std::uint8_t>(result.ptr - first);
  }
  std::memcpy(at, column.last_text.data(), kLongestNumber);  // of fixed size, which is cheaper than the right one
  return at + column.last_size;
}

void CsvSink::write(const RowBlock& block) {
  const auto* cell = block.cells.data();
  for (std::size_t row = 0; row < block.rows(); ++row) {
    char* at = line_.data();
    at = std::to_chars(at, at + kLongestNumber, std::bit_cast<double>(*cell++)).ptr;
    for (auto& column : columns_) {
      *at++ = ',';
      if (column.kind == ValueKind::string) {
        file_->buffer().append(line_.data(), at);
        file_->buffer() += csv_text(block.texts[*cell++]);
        at = line_.data();
      } else {
        at = write_number(at, column, *cell++);
      }
    }
    *at++ = '\n';
    file_->buffer().append(line_.data(), at);
    file_->written();
  }
}

void CsvSink::visit(state::Visitor& v) {
  file_->flush();
  std::uint64_t size = file_->size();
  v("size", size);
  if (v.restores()) file_->truncate(size);
}

void copy_csv_rows(const std::filesystem::path& file, std::uint64_t bytes, const std::vector<RecordColumn>& columns,
                   RowSink& sink) {
  std::string text(bytes, '\0');
  std::ifstream stream(file, std::ios::binary);
  if (!stream.read(text.data(), static_cast<std::streamsize>(bytes))) {
    throw Error(ErrorCode::file_unreadable, fmt::format("{}: this file cannot be read", file.string()));
  }
  const auto fail = [&] {
    throw Error(ErrorCode::state_damaged,
                fmt::format("{}: this file does not hold the rows that were written", file.string()));
  };
  data::CsvReader reader(text, file.string());
  if (reader.header().size() != columns.size() + 1) fail();
  RowBlock block;
  block.cells_per_row = columns.size() + 1;
  while (reader.next()) {
    const auto time_s = data::csv_number<double>(reader.cell(0));
    if (!time_s) fail();
    block.cells.push_back(std::bit_cast<std::uint64_t>(*time_s));
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const auto cell = reader.cell(i + 1);
      if (columns[i].kind == ValueKind::string) {
        block.cells.push_back(block.texts.size());
        block.texts.emplace_back(cell);
      } else if (columns[i].kind == ValueKind::real) {
        const auto value = data::csv_number<double>(cell);
        if (!value) fail();
        block.cells.push_back(std::bit_cast<std::uint64_t>(*value));
      } else {
        const auto value = data::csv_number<std::int64_t>(cell);
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
