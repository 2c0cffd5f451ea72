// SPDX-License-Identifier: Apache-2.0
// tinygltf's code: its header holds all of it, for one translation unit (fmu_world/CMakeLists.txt leaves its pictures
// out).
#define TINYGLTF_IMPLEMENTATION
#include <tiny_gltf.h>
