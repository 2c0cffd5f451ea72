// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "record/sink/row_block.hpp"

#include <cstdint>
#include <filesystem>
#include <vector>

namespace mebots::master {

/// Reads the first `bytes` of a results.csv with these columns back, to the same bits, into another sink. Throws
/// Error for a file that a CsvSink did not write.
void copy_csv_rows(const std::filesystem::path& file, std::uint64_t bytes, const std::vector<RecordColumn>& columns,
                   RowSink& sink);

}  // namespace mebots::master
