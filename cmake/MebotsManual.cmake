# SPDX-License-Identifier: Apache-2.0
# Installs manual pages, and completion for bash, fish and zsh. The programs generate both from their parsers.
set(manual_folder ${PROJECT_BINARY_DIR}/manual)
file(MAKE_DIRECTORY ${manual_folder}/man1 ${manual_folder}/bash ${manual_folder}/fish ${manual_folder}/zsh)
set(told)
foreach(program mebots mebots-boardgen mebots-modeldesc mebots-soc)
  if(NOT TARGET ${program})
    continue()
  endif()
  add_custom_command(
    OUTPUT ${manual_folder}/man1/${program}.1 ${manual_folder}/bash/${program} ${manual_folder}/fish/${program}.fish
           ${manual_folder}/zsh/_${program}
    COMMAND ${program} --write-manuals ${manual_folder}/man1
    COMMAND ${program} --print-completion bash > ${manual_folder}/bash/${program}
    COMMAND ${program} --print-completion fish > ${manual_folder}/fish/${program}.fish
    COMMAND ${program} --print-completion zsh > ${manual_folder}/zsh/_${program}
    DEPENDS ${program}
    COMMENT "Manual and completion of ${program}"
    VERBATIM)
  list(APPEND told ${manual_folder}/man1/${program}.1)
endforeach()
add_custom_target(mebots_manual ALL DEPENDS ${told})

install(DIRECTORY ${manual_folder}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR})
install(DIRECTORY ${manual_folder}/bash/ DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
install(DIRECTORY ${manual_folder}/fish/ DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
install(DIRECTORY ${manual_folder}/zsh/ DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
