// SPDX-License-Identifier: Apache-2.0
// Reads any text as the file of a battery cell, and as the file of converters. Each reader must throw Error, or return
// data. A cell must have a finite capacity above 0.
#include "cell.hpp"
#include "converter.hpp"

#include "mebots/error.hpp"
#include "memory_file.hpp"

#include <cmath>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace mebots;
  static fuzz::MemoryFile file;
  const auto& path = file.with(data, size);
  try {
    const auto cell = battery::load_cell(path);
    fuzz::require(std::isfinite(cell.capacity_c) && cell.capacity_c > 0, "a cell holds a charge");
  } catch (const Error&) {
  }
  try {
    battery::load_converters(path);
  } catch (const Error&) {
  }
  return 0;
}
