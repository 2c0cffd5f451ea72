// SPDX-License-Identifier: Apache-2.0
#include "base/sha256.hpp"

#include "mebots/assert.hpp"
#include "mebots/input_error.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <vector>

namespace mebots::master {
namespace {

class Sha256 {
 public:
  Sha256() : context_(EVP_MD_CTX_new(), &EVP_MD_CTX_free) {
    if (!context_ || EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) != 1) fail();
  }

  void add(std::string_view bytes) {
    if (EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size()) != 1) fail();
  }

  /// Returns the hash of all bytes until now. More bytes may follow.
  std::string so_far() const {
    Sha256 copy;
    if (EVP_MD_CTX_copy_ex(copy.context_.get(), context_.get()) != 1) fail();
    return copy.hexadecimal();
  }

  std::string hexadecimal() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned int size = 0;
    if (EVP_DigestFinal_ex(context_.get(), digest.data(), &size) != 1) fail();
    std::string text;
    for (unsigned int i = 0; i < size; ++i) text += fmt::format("{:02x}", digest[i]);
    return text;
  }

 private:
  [[noreturn]] static void fail() {
    throw Error(ErrorCode::system_failure, "OpenSSL offers no SHA-256 on this machine");
  }

  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

}  // namespace

std::string sha256(std::string_view bytes) {
  Sha256 hash;
  hash.add(bytes);
  return hash.hexadecimal();
}

std::string sha256_of_file(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  Sha256 hash;
  std::vector<char> block(1 << 16);
  while (stream.read(block.data(), static_cast<std::streamsize>(block.size())) || stream.gcount() > 0) {
    hash.add({block.data(), static_cast<std::size_t>(stream.gcount())});
  }
  if (!stream.eof())
    throw InputError(ErrorCode::file_unreadable, fmt::format("{}: the file cannot be read", file.string()));
  return hash.hexadecimal();
}

class GrowingFileHash::Progress : public Sha256 {};

GrowingFileHash::GrowingFileHash() : progress_(std::make_unique<Progress>()) {}

GrowingFileHash::~GrowingFileHash() = default;

std::string GrowingFileHash::up_to(const std::filesystem::path& file, std::uint64_t bytes) {
  MEBOTS_ASSERT(bytes >= bytes_);
  std::ifstream stream(file, std::ios::binary);
  stream.seekg(static_cast<std::streamoff>(bytes_));
  std::vector<char> block(1 << 16);
  while (bytes_ < bytes) {
    const auto wanted = std::min<std::uint64_t>(block.size(), bytes - bytes_);
    if (!stream.read(block.data(), static_cast<std::streamsize>(wanted)))
      throw InputError(ErrorCode::file_unreadable,
                       fmt::format("{}: its first {} bytes cannot be read", file.string(), bytes));
    progress_->add({block.data(), static_cast<std::size_t>(wanted)});
    bytes_ += wanted;
  }
  return progress_->so_far();
}

}  // namespace mebots::master
