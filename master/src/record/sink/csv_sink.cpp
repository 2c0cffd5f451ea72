// SPDX-License-Identifier: Apache-2.0
#include "record/sink/csv_sink.hpp"

#include "mebots/data/csv.hpp"
#include "mebots/error.hpp"
#include "mebots/parsed_number.hpp"

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
    columns_.push_back({column.type, 0, 0, {}});
    header += ',' + csv_header(column.name, column.unit);
  }
  line_.resize((columns.size() + 1) * (kLongestNumber + 1));
  if (file_->size() == 0) file_->append(header + '\n');
}

namespace {

/// Writes the shortest text that preserves the bits. Returns the end of the text.
char* number_to_chars(char* first, char* last, modeldesc::Type type, std::uint64_t cell) {
  using modeldesc::Type;
  if (type == Type::real) return std::to_chars(first, last, std::bit_cast<double>(cell)).ptr;
  if (type == Type::float32) return std::to_chars(first, last, static_cast<float>(std::bit_cast<double>(cell))).ptr;
  if (type == Type::uint64) return std::to_chars(first, last, cell).ptr;
  return std::to_chars(first, last, static_cast<std::int64_t>(cell)).ptr;
}

bool is_text(modeldesc::Type type) {
  return kind_of(type) == ValueKind::string || kind_of(type) == ValueKind::binary;
}

/// Converts a text to the bits of a cell. Returns nullopt if the text is not a number of the type.
std::optional<std::uint64_t> cell_of(modeldesc::Type type, std::string_view text) {
  if (type == modeldesc::Type::uint64) return parsed_number<std::uint64_t>(text);
  if (kind_of(type) == ValueKind::real) {
    const auto value = parsed_number<double>(text);
    if (!value) return std::nullopt;
    const bool is_narrow = type == modeldesc::Type::float32;
    return std::bit_cast<std::uint64_t>(is_narrow ? static_cast<double>(static_cast<float>(*value)) : *value);
  }
  const auto value = parsed_number<std::int64_t>(text);
  return value ? std::optional(static_cast<std::uint64_t>(*value)) : std::nullopt;
}

}  // namespace

char* CsvSink::write_number(char* at, Column& column, std::uint64_t cell) {
  if (column.last_size == 0 || cell != column.last) {
    char* const first = column.last_text.data();
    const char* const end = number_to_chars(first, first + column.last_text.size(), column.type, cell);
    column.last = cell;
    column.last_size = static_cast<std::uint8_t>(end - first);
  }
  // A constant size is faster than the exact size.
  std::memcpy(at, column.last_text.data(), kLongestNumber);
  return at + column.last_size;
}

void CsvSink::write(const RowBlock& block) {
  const auto* cell = block.cells.data();
  for (std::size_t row = 0; row < block.rows(); ++row) {
    char* at = line_.data();
    at = std::to_chars(at, at + kLongestNumber, std::bit_cast<double>(*cell++)).ptr;
    for (auto& column : columns_) {
      *at++ = ',';
      if (is_text(column.type)) {
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
                fmt::format("{}: this file does not contain the rows that the run wrote", file.string()));
  };
  data::CsvReader reader(text, file.string());
  if (reader.header().size() != columns.size() + 1) fail();
  RowBlock block;
  block.cells_per_row = columns.size() + 1;
  while (reader.next()) {
    const auto time_s = parsed_number<double>(reader.cell(0));
    if (!time_s) fail();
    block.cells.push_back(std::bit_cast<std::uint64_t>(*time_s));
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const auto cell = reader.cell(i + 1);
      if (is_text(columns[i].type)) {
        block.cells.push_back(block.texts.size());
        block.texts.emplace_back(cell);
      } else {
        const auto value = cell_of(columns[i].type, cell);
        if (!value) fail();
        block.cells.push_back(*value);
      }
    }
    if (block.cells.size() < kBlockCells) continue;
    sink.write(block);
    block.clear();
  }
  sink.write(block);
}

}  // namespace mebots::master
