# SPDX-License-Identifier: Apache-2.0
#
# Writes one line MEBOTS_KIND(name) to OUT for each MEBOTS_CHIP_KIND(name, ...) in FILES, in the order of the names.
set(kinds)
foreach(file IN LISTS FILES)
  file(STRINGS ${file} lines REGEX "^MEBOTS_CHIP_KIND\\(")
  foreach(line IN LISTS lines)
    string(REGEX REPLACE "^MEBOTS_CHIP_KIND\\(([a-z0-9_]+).*" "\\1" kind "${line}")
    list(APPEND kinds ${kind})
  endforeach()
endforeach()
list(SORT kinds)
list(TRANSFORM kinds REPLACE "(.+)" "MEBOTS_KIND(\\1)\n")
list(JOIN kinds "" text)
file(CONFIGURE OUTPUT ${OUT} CONTENT "${text}" @ONLY)
