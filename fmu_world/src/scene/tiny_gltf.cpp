// SPDX-License-Identifier: Apache-2.0
// Compiles tinygltf's header, which one translation unit must implement. The definitions in fmu_world/CMakeLists.txt
// exclude its decoder of pictures.
#define TINYGLTF_IMPLEMENTATION
#include <tiny_gltf.h>
