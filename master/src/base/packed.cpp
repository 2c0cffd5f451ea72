// SPDX-License-Identifier: Apache-2.0
#include "base/packed.hpp"

#include "mebots/error.hpp"

#include <libdeflate.h>

#include <cstddef>
#include <cstdint>
#include <memory>

namespace mebots::master {
namespace {

constexpr std::size_t kMostBytes = std::size_t{256} << 20;

using Decompressor = std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)>;

/// Returns the size of the decompressed content from the last four bytes of a gzip file (little-endian).
std::size_t size_at_end_of(std::string_view file) {
  std::size_t size = 0;
  for (std::size_t i = 1; i <= sizeof(std::uint32_t); ++i) {
    size = size << 8 | static_cast<std::uint8_t>(file[file.size() - i]);
  }
  return size;
}

}  // namespace

std::string gunzipped(std::string_view bytes) {
  constexpr std::size_t kLeastBytes = 18;  // size of header and trailer
  const auto damaged = [] { return Error(ErrorCode::syntax_error, "this is not a gzip file, or it is damaged"); };
  if (bytes.size() < kLeastBytes) throw damaged();
  const auto size = size_at_end_of(bytes);
  if (size > kMostBytes) throw damaged();
  const Decompressor decompressor(libdeflate_alloc_decompressor(), &libdeflate_free_decompressor);
  if (decompressor == nullptr) throw Error(ErrorCode::system_failure, "out of memory while decompressing");
  std::string result(size, '\0');
  constexpr std::size_t* kExactly = nullptr;  // also rejects a smaller result
  if (libdeflate_gzip_decompress(decompressor.get(), bytes.data(), bytes.size(), result.data(), size, kExactly) !=
      LIBDEFLATE_SUCCESS) {
    throw damaged();
  }
  return result;
}

}  // namespace mebots::master
