# SPDX-License-Identifier: Apache-2.0
# Tests the functions of cmake/BoardWith.cmake: cmake -DROOT=... -DFOLDER=... [-DCALL=...] -P boards_test.cmake. With CALL, only makes this call.
cmake_minimum_required(VERSION 3.25)
include(${ROOT}/cmake/BoardWith.cmake)
set(boards ${ROOT}/configs/boards)
set(devices ${ROOT}/fmu_soc/boards)
if(DEFINED CALL)
  cmake_language(EVAL CODE "${CALL}")
  return()
endif()

# refuse(<text of the error> <call>)
function(refuse text call)
  execute_process(COMMAND ${CMAKE_COMMAND} -DROOT=${ROOT} -DFOLDER=${FOLDER} "-DCALL=${call}" -P ${CMAKE_CURRENT_LIST_FILE}
    RESULT_VARIABLE code ERROR_VARIABLE errors OUTPUT_QUIET)
  string(REGEX REPLACE "[ \n]+" " " errors "${errors}")
  string(FIND "${errors}" "${text}" place)
  if(code EQUAL 0 OR place EQUAL -1)
    message(SEND_ERROR "${call}\nexit code ${code}, expected was the error '${text}':\n${errors}")
  endif()
endfunction()

function(expect value expected)
  if(NOT value STREQUAL expected)
    message(SEND_ERROR "'${value}' is not '${expected}'")
  endif()
endfunction()

file(MAKE_DIRECTORY ${FOLDER})
mebots_board_with(${FOLDER}/whole.json NAME whole TEXT "With a UART" BOARD ${boards}/flight_controller.json
  DEVICES ${devices}/uart.json ${devices}/commander.json)
mebots_board_has_companion(plain ${boards}/flight_controller.json)
mebots_board_has_companion(whole ${FOLDER}/whole.json)
expect(${plain} FALSE)
expect(${whole} TRUE)

# Devices are added to a board without any. One of the same name is replaced.
file(WRITE ${FOLDER}/empty.json "{\"devices\": []}")
mebots_board_with(${FOLDER}/one.json NAME one TEXT "One device" BOARD ${FOLDER}/empty.json DEVICES ${devices}/uart.json ${devices}/uart.json)
file(READ ${FOLDER}/one.json one)
mebots_board_devices("${one}" names kinds)
expect("${names} ${kinds}" "uart uart")

refuse("no device commander" "mebots_board_has_companion(x ${FOLDER}/one.json)")
string(REPLACE "\"name\" : \"uart\"" "\"name\" : \"line\"" other "${one}")
file(WRITE ${FOLDER}/other.json "${other}")
refuse("the UART is named 'line'" "mebots_board_has_companion(x ${FOLDER}/other.json)")
mebots_board_with(${FOLDER}/half.json NAME half TEXT "With a UART" BOARD ${boards}/flight_controller.json DEVICES ${devices}/uart.json)
refuse("no device commander with counts of frames" "mebots_board_has_companion(x ${FOLDER}/half.json)")
refuse("expected is <file> NAME" "mebots_board_with(x.json NAME x TEXT x DEVICES ${devices}/uart.json)")
refuse("expected is <file> NAME" "mebots_board_with(x.json COLOUR red NAME x TEXT x BOARD ${FOLDER}/one.json DEVICES ${devices}/uart.json)")
