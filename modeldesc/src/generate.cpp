// SPDX-License-Identifier: Apache-2.0
#include "generate.hpp"

#include "mebots/error.hpp"
#include "mebots/modeldesc/xml.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <fstream>

namespace mebots::modeldesc {
namespace {

void make_output_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    throw Error(ErrorCode::file_unwritable, fmt::format("{}: cannot be created: {}", folder.string(), error.message()));
}

/// Writes the files that only FMI 3.0 uses. Returns the instantiation token.
std::string generate_fmi3(const Description& description, const ModelDescription& common,
                          const GenerateOptions& options, const std::filesystem::path& folder) {
  make_output_folder(folder);
  const Fmi3Text text = write_fmi3_xml(description, common);
  write_text_file(folder / "modelDescription.xml", text.xml);
  write_text_file(folder / "index.html", write_fmi3_html(description, common));
  // Writes the file even if it is empty, because the build expects the file.
  write_text_file(folder / "terminalsAndIcons.xml", write_terminals_and_icons(description, options.has_icon));
  if (!options.fmi3_sources.empty())
    write_text_file(folder / "buildDescription.xml", write_build_description(description.name, options.fmi3_sources));
  return text.token;
}

}  // namespace

void generate(const Description& description, const std::filesystem::path& folder, const GenerateOptions& options) {
  auto versions = options.fmi.empty() ? description.fmi : options.fmi;
  if (versions.empty()) versions = {FmiVersion::two};
  const auto wants = [&](FmiVersion version) { return std::ranges::find(versions, version) != versions.end(); };
  make_output_folder(folder);
  const ModelDescription model = to_model_description(description, options.fmi2_sources);
  std::string token;
  if (wants(FmiVersion::three))
    token = generate_fmi3(description, model, options, wants(FmiVersion::two) ? folder / "fmi3" : folder);
  if (wants(FmiVersion::two)) {
    write_text_file(folder / "modelDescription.xml", write_xml(model));
    write_text_file(folder / "index.html", write_html(model));
  }
  write_text_file(folder / "variables.hpp", variables_header(description));
  write_text_file(folder / "binding.hpp", binding_header(description));
  write_text_file(folder / "variable_table.cpp", variable_table_source(description, model.guid, token));
}

void write_text_file(const std::filesystem::path& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  stream << text;
  stream.close();
  if (!stream)
    throw Error(ErrorCode::file_unwritable,
                fmt::format("{}: cannot be written; check permissions and free space", file.string()));
}

std::string sha256_hex(std::string_view bytes) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), &size, EVP_sha256(), nullptr) != 1)
    throw Error(ErrorCode::system_failure, "SHA-256 is not available in this machine's OpenSSL");
  std::string hex;
  for (unsigned int i = 0; i < size; ++i) hex += fmt::format("{:02x}", digest[i]);
  return hex;
}

std::string token_of(const std::string& text) {
  const std::string digest = sha256_hex(text);
  return fmt::format("{{{}-{}-{}-{}-{}}}", digest.substr(0, 8), digest.substr(8, 4), digest.substr(12, 4),
                     digest.substr(16, 4), digest.substr(20, 12));
}

}  // namespace mebots::modeldesc
