// SPDX-License-Identifier: Apache-2.0
// Generated from params/*.json by CMake. Do not edit.
#pragma once

namespace mebots::soc {

inline constexpr const char* kGap8Json = R"json(@MEBOTS_SOC_CHIP_JSON@)json";
inline constexpr const char* kGap8SiliconJson = R"json(@MEBOTS_SOC_SILICON_JSON@)json";

}  // namespace mebots::soc
