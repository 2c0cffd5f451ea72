# SPDX-License-Identifier: Apache-2.0

# mebots_require_same_fmu(<archive> <archive of this build>)
# Fails if the two are not builds of one FMU, which have the same description.
function(mebots_require_same_fmu archive own)
  set(folder ${own}.compared)
  foreach(file archive own)
    file(ARCHIVE_EXTRACT INPUT ${${file}} DESTINATION ${folder}/${file} PATTERNS modelDescription.xml)
    file(SHA256 ${folder}/${file}/modelDescription.xml hash_of_${file})
  endforeach()
  file(REMOVE_RECURSE ${folder})
  if(NOT hash_of_archive STREQUAL hash_of_own)
    message(FATAL_ERROR "${archive} is not a build of the same FMU as ${own}: their modelDescription.xml differ. Run scripts/platforms.sh again")
  endif()
endfunction()
