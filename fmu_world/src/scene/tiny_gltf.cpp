// SPDX-License-Identifier: Apache-2.0
// Compiles tinygltf, which is a header that one translation unit must implement. fmu_world/CMakeLists.txt excludes its
// code for pictures.
#define TINYGLTF_IMPLEMENTATION
#include <tiny_gltf.h>
