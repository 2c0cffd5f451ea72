// SPDX-License-Identifier: Apache-2.0
#include "base/packed.hpp"

#include "mebots/error.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <array>
#include <cstddef>
#include <memory>

namespace mebots::master {
namespace {

constexpr int kZlib = MAX_WBITS;       ///< windowBits of RFC 1950
constexpr int kGzip = MAX_WBITS + 16;  ///< of RFC 1952
constexpr int kMemoryLevel = 9;
constexpr std::size_t kMostBytes = std::size_t{256} << 20;

Bytef* writable(std::string_view bytes) {
  return reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));  // zlib's next_in is const in all but its type
}

void require(bool good, const char* what, int answer) {
  if (!good) throw Error(ErrorCode::system_failure, fmt::format("zlib cannot {}: code {}", what, answer));
}

std::string packed(std::string_view bytes, int window_bits) {
  z_stream stream{};
  int answer = deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, window_bits, kMemoryLevel, Z_DEFAULT_STRATEGY);
  require(answer == Z_OK, "deflate", answer);
  const std::unique_ptr<z_stream, decltype(&deflateEnd)> end(&stream, &deflateEnd);
  std::string result(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = writable(bytes);
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = writable(result);
  stream.avail_out = static_cast<uInt>(result.size());
  require(stream.avail_in == bytes.size() && stream.avail_out == result.size(), "deflate more than 4 GiB", 0);
  answer = deflate(&stream, Z_FINISH);
  require(answer == Z_STREAM_END, "deflate", answer);
  result.resize(stream.total_out);
  return result;
}

}  // namespace

std::string deflated(std::string_view bytes) {
  return packed(bytes, kZlib);
}

std::string gzipped(std::string_view bytes) {
  return packed(bytes, kGzip);
}

std::string gunzipped(std::string_view bytes) {
  z_stream stream{};
  int answer = inflateInit2(&stream, kGzip);
  require(answer == Z_OK, "inflate", answer);
  const std::unique_ptr<z_stream, decltype(&inflateEnd)> end(&stream, &inflateEnd);
  stream.next_in = writable(bytes);
  stream.avail_in = static_cast<uInt>(bytes.size());
  std::string result;
  std::array<char, 1 << 16> piece;
  while (answer != Z_STREAM_END) {
    stream.next_out = reinterpret_cast<Bytef*>(piece.data());
    stream.avail_out = piece.size();
    answer = inflate(&stream, Z_NO_FLUSH);
    if ((answer != Z_OK && answer != Z_STREAM_END) || result.size() > kMostBytes) {
      throw Error(ErrorCode::syntax_error, "this is not a file of gzip, or it is damaged");
    }
    result.append(piece.data(), piece.size() - stream.avail_out);
  }
  return result;
}

}  // namespace mebots::master
