// SPDX-License-Identifier: Apache-2.0
#include "generate.hpp"

#include "mebots/error.hpp"
#include "mebots/modeldesc/xml.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <array>
#include <fstream>

namespace mebots::modeldesc {
void generate(const Description& description, const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    throw Error(ErrorCode::file_unwritable, fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
  const ModelDescription model = to_model_description(description);
  write_text_file(folder / "modelDescription.xml", write_xml(model));
  write_text_file(folder / "index.html", write_html(model));
  write_text_file(folder / "variables.hpp", variables_header(description));
  write_text_file(folder / "binding.hpp", binding_header(description));
  write_text_file(folder / "variable_table.cpp", variable_table_source(description, model.guid));
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

}  // namespace mebots::modeldesc
