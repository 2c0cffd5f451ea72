// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "io/ssp/ssp.hpp"

#include "files.hpp"

namespace mebots::master::ssp {

/// read_ssp() wherever the files lie; `archive` names the SSP in messages. Throws InputError.
SspConfig read(const Files& files, const std::string& archive, const std::string& ssd = "SystemStructure.ssd");

}  // namespace mebots::master::ssp
