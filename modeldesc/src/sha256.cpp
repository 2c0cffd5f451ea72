// SPDX-License-Identifier: Apache-2.0
#include "sha256.hpp"

#include "mebots/error.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <array>

namespace mebots::modeldesc {

std::string sha256_hex(std::string_view bytes) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), &size, EVP_sha256(), nullptr) != 1)
    throw Error(ErrorCode::system_failure, "SHA-256 is not available in this machine's OpenSSL");
  std::string hex;
  for (unsigned int i = 0; i < size; ++i) hex += fmt::format("{:02x}", digest[i]);
  return hex;
}

}  // namespace mebots::modeldesc
