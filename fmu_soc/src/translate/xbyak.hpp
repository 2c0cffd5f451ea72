// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <xbyak/xbyak.h>

// On Windows, xbyak includes <windows.h>, which defines these words as macros.
#ifdef _WIN32
#undef far
#undef near
#endif
