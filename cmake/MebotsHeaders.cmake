# SPDX-License-Identifier: Apache-2.0

# mebots_included_headers(<variable> <root> <file>...)
# Returns the headers below <root> that these files include, directly or indirectly, as paths relative to <root>.
function(mebots_included_headers variable root)
  set(open ${ARGN})
  set(found)
  while(open)
    list(POP_FRONT open file)
    file(STRINGS ${root}/${file} lines REGEX "^#include \"")
    foreach(line IN LISTS lines)
      string(REGEX REPLACE "^#include \"([^\"]+)\".*" "\\1" name "${line}")
      list(FIND found ${name} known)  # IN_LIST needs a policy, which an installation script has not
      if(EXISTS ${root}/${name} AND known EQUAL -1)
        list(APPEND found ${name})
        list(APPEND open ${name})
      endif()
    endforeach()
  endwhile()
  set(${variable} ${found} PARENT_SCOPE)
endfunction()
