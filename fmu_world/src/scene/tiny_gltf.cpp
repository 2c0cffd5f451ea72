// SPDX-License-Identifier: Apache-2.0
// tinygltf's code. It is all in its header, for one translation unit (fmu_world/CMakeLists.txt excludes its pictures).
#define TINYGLTF_IMPLEMENTATION
#include <tiny_gltf.h>
