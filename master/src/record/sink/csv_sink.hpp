// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "record/sink/output_file.hpp"
#include "record/sink/row_block.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::master {

/// Writes rows as CSV: numbers in their shortest form that reads back to the same bits, Booleans as 0 and 1,
/// enumerations as their numbers, texts quoted if necessary.
class CsvSink final : public RowSink {
 public:
  /// Writes the header unless the file already contains rows. `file` must outlive the sink.
  CsvSink(const std::vector<RecordColumn>& columns, OutputFile& file);

  void write(const RowBlock& block) override;
  void flush() override { file_->flush(); }
  void visit(state::Visitor& v) override;
  std::string_view state_name() const override { return "csv"; }

 private:
  /// The longest double in its shortest form has 24 characters.
  static constexpr std::size_t kLongestNumber = 24;

  struct Column {
    modeldesc::Type type;
    // Most variables rarely change, so the text of the last value is cached.
    std::uint64_t last = 0;
    std::uint8_t last_size = 0;
    std::array<char, kLongestNumber> last_text{};
  };

  char* write_number(char* at, Column& column, std::uint64_t cell);

  OutputFile* file_;
  std::vector<Column> columns_;
  std::vector<char> line_;  // buffer for one row's numbers
};

/// Returns "name [unit]", quoted if it contains a comma or a quotation mark.
std::string csv_header(std::string_view name, std::string_view unit);

/// Returns a text as one cell, quoted if it contains a comma, a quotation mark or a line break.
std::string csv_text(std::string_view text);

/// Reads the first `bytes` bytes of a results.csv with these columns, and writes the rows into another sink. All values
/// keep their bits. Throws Error if the file was not written by a CsvSink.
void copy_csv_rows(const std::filesystem::path& file, std::uint64_t bytes, const std::vector<RecordColumn>& columns,
                   RowSink& sink);

}  // namespace mebots::master
