// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace mebots::modeldesc {

/// Throws mebots::Error naming the file.
void write_text_file(const std::filesystem::path& file, const std::string& text);

}  // namespace mebots::modeldesc
