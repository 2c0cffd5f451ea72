// SPDX-License-Identifier: Apache-2.0
// Compiles tinygltf, which is a header that one translation unit must implement. The definitions in
// fmu_world/CMakeLists.txt exclude its decoder for pictures.
#define TINYGLTF_IMPLEMENTATION
#include <tiny_gltf.h>
