// SPDX-License-Identifier: Apache-2.0
#include "mebots/packed.hpp"

#include "mebots/error.hpp"

#include <libdeflate.h>

#include <memory>

namespace mebots {
namespace {

using Compressor = std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)>;

template <typename Bound, typename Compress>
std::string packed(std::string_view bytes, Packing packing, Bound bound, Compress compress) {
  constexpr int kFastLevel = 1;
  constexpr int kSmallLevel = 9;  // higher levels take four times as long for 5 % less
  const Compressor compressor(libdeflate_alloc_compressor(packing == Packing::fast ? kFastLevel : kSmallLevel),
                              &libdeflate_free_compressor);
  if (compressor == nullptr) throw Error(ErrorCode::system_failure, "no memory is left to deflate anything");
  std::string result(bound(compressor.get(), bytes.size()), '\0');
  result.resize(compress(compressor.get(), bytes.data(), bytes.size(), result.data(), result.size()));
  return result;
}

}  // namespace

std::string deflated(std::string_view bytes, Packing packing) {
  return packed(bytes, packing, libdeflate_zlib_compress_bound, libdeflate_zlib_compress);
}

std::string gzipped(std::string_view bytes, Packing packing) {
  return packed(bytes, packing, libdeflate_gzip_compress_bound, libdeflate_gzip_compress);
}

}  // namespace mebots
