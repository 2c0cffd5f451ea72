// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model.hpp"
#include "xml_file.hpp"

#include <memory>
#include <string>
#include <vector>

namespace mebots::master::ssp {

/// An SSD (SSP 2.0, chapter 5) with all that its system refers to.
struct Document {
  std::shared_ptr<const XmlFile> file;  ///< for the sections that are read from it later
  Element system;
};

/// Reads an SSD and, in place of each component that is another SSD, the system of that one. Throws InputError naming
/// file, line and element.
Document read_document(const Source& source, const std::filesystem::path& ssd);

}  // namespace mebots::master::ssp
