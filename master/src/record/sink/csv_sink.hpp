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

/// Writes rows as CSV. Numbers have the fewest digits that preserve their bits. Booleans become 0 and 1, enumerations
/// their numbers. Texts are quoted if necessary.
class CsvSink final : public RowSink {
 public:
  /// Writes the header, unless the file already contains rows. `file` must outlive the sink.
  CsvSink(const std::vector<RecordColumn>& columns, OutputFile& file);

  void write(const RowBlock& block) override;
  void flush() override { file_->flush(); }
  void visit(state::Visitor& v) override;
  std::string_view state_name() const override { return "csv"; }

 private:
  /// Maximum length of the text of a double.
  static constexpr std::size_t kLongestNumber = 24;

  struct Column {
    modeldesc::Type type;
    // Caches the text of the last value, because most variables rarely change.
    std::uint64_t last = 0;
    std::uint8_t last_size = 0;
    std::array<char, kLongestNumber> last_text{};
  };

  char* write_number(char* at, Column& column, std::uint64_t cell);

  OutputFile* file_;
  std::vector<Column> columns_;
  std::vector<char> line_;  // numbers of one row
};

/// Returns "name [unit]", in quotes if the text contains a comma or a quotation mark.
std::string csv_header(std::string_view name, std::string_view unit);

/// Returns a CSV cell, in quotes if the text contains a comma, a quotation mark or a line break.
std::string csv_text(std::string_view text);

/// Reads the first `bytes` bytes of a results.csv with these columns and copies its rows to another sink. Preserves all
/// bits. Throws Error if no CsvSink wrote the file.
void copy_csv_rows(const std::filesystem::path& file, std::uint64_t bytes, const std::vector<RecordColumn>& columns,
                   RowSink& sink);

}  // namespace mebots::master
