// SPDX-License-Identifier: Apache-2.0
#include "mebots/modeldesc/system_libraries.hpp"

#include <algorithm>
#include <cctype>

namespace mebots::modeldesc {

bool is_part_of_linux(std::string_view soname) {
  constexpr std::string_view kPrefixes[] = {
      "libc.so.",      "libm.so.",     "libdl.so.",   "libpthread.so.", "librt.so.",   "ld-linux",
      "libstdc++.so.", "libgcc_s.so.", "libasan.so.", "libubsan.so.",   "libtsan.so.", "liblsan.so.",
  };
  return std::ranges::any_of(kPrefixes, [&](std::string_view prefix) { return soname.starts_with(prefix); });
}

bool is_part_of_windows(std::string_view dll) {
  constexpr std::string_view kDlls[] = {
      "advapi32.dll", "bcrypt.dll",   "comctl32.dll", "comdlg32.dll", "crypt32.dll",  "dbghelp.dll",  "gdi32.dll",
      "imm32.dll",    "iphlpapi.dll", "kernel32.dll", "msvcrt.dll",   "ntdll.dll",    "ole32.dll",    "oleaut32.dll",
      "psapi.dll",    "rpcrt4.dll",   "secur32.dll",  "setupapi.dll", "shell32.dll",  "shlwapi.dll",  "ucrtbase.dll",
      "user32.dll",   "userenv.dll",  "version.dll",  "winmm.dll",    "winspool.drv", "ws2_32.dll",   "wsock32.dll",
      "opengl32.dll", "glu32.dll",    "uxtheme.dll",  "wininet.dll",  "wtsapi32.dll", "powrprof.dll", "normaliz.dll",
  };
  std::string name(dll);
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return name.starts_with("api-ms-win-") || std::ranges::find(kDlls, name) != std::end(kDlls);
}

}  // namespace mebots::modeldesc
