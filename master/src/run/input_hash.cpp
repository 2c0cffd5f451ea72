// SPDX-License-Identifier: Apache-2.0
#include "run/input_hash.hpp"

#include "mebots/assert.hpp"
#include "mebots/file_kind.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <memory>

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

  /// Of all bytes so far; more may follow.
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

/// Files that texts among the parameters name, as the FMU would open them: from the working folder.
std::map<std::string, std::filesystem::path> named_files(const SystemDescription& system) {
  std::map<std::string, std::filesystem::path> files;  // the last assignment to a parameter counts
  for (const auto& instance : system.instances) {
    for (const auto& assignment : instance.parameters) {
      const auto name = instance.name + "." + assignment.variable;
      files.erase(name);
      const auto* text = std::get_if<std::string>(&assignment.value);
      if (const auto* typed = std::get_if<UntypedText>(&assignment.value)) text = &typed->text;
      if (text != nullptr && is_file(*text)) files[name] = *text;
    }
  }
  return files;
}

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

InputHash hash_inputs(const SystemDescription& system, std::span<const std::string> overrides) {
  InputHash hash;
  hash.config = sha256(system.source);
  std::map<std::filesystem::path, std::string> known;  // instances may share an FMU
  auto lines = fmt::format("config {}\n", hash.config);
  for (const auto& instance : system.instances) {
    auto& digest = known[instance.fmu_path];
    if (digest.empty()) digest = sha256_of_file(instance.fmu_path);
    hash.fmus.emplace_back(instance.name, digest);
    lines += fmt::format("fmu {} {}\n", instance.name, digest);
  }
  for (const auto& [name, file] : named_files(system)) {
    hash.files.emplace_back(name, sha256_of_file(file));
    lines += fmt::format("file {} {}\n", name, hash.files.back().second);
  }
  const auto add_signals = [&](const std::string& name, const SignalFileDescription& file) {
    hash.files.emplace_back(name, sha256_of_file(file.path));
    lines += fmt::format("file {} {}\n", name, hash.files.back().second);
  };
  for (std::size_t i = 0; i < system.inputs.size(); ++i) {
    add_signals(fmt::format("inputs/{} {}", i, system.inputs[i].file.name), system.inputs[i].file);
  }
  for (std::size_t i = 0; i < system.scenario.size(); ++i) {
    const auto& file = system.scenario[i].file;
    if (file) add_signals(fmt::format("scenario/{} {}", i, file->name), *file);
  }
  for (const auto& change : overrides) lines += fmt::format("change {}\n", change);
  hash.all = sha256(lines);
  hash.lines = std::move(lines);
  return hash;
}

}  // namespace mebots::master
