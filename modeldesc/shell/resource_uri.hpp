// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

namespace mebots::shell {

/// The folder that a `file:` URI (RFC 8089) names; percent-encoded bytes are taken apart. Throws mebots::Error.
std::filesystem::path path_of_file_uri(std::string_view uri);

}  // namespace mebots::shell
