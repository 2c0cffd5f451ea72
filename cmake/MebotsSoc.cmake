# SPDX-License-Identifier: Apache-2.0
#
# What a board needs: headers, firmware, and the chip's FMU built with it. A folder that calls these three adds a board,
# its sensors included, without a change anywhere else.

find_program(MEBOTS_RISCV_GCC riscv64-unknown-elf-gcc DOC "Bare-metal RISC-V C compiler for the firmware")
if(NOT MEBOTS_RISCV_GCC)
  message(FATAL_ERROR "riscv64-unknown-elf-gcc is missing: install Debian's gcc-riscv64-unknown-elf (scripts/setup.sh)")
endif()
# GCC's library has no rv32imc folder and takes rv32im's. The march of the link has no _zicsr: with it, GCC 12 does not
# find its 32-bit libraries.
execute_process(
  COMMAND ${MEBOTS_RISCV_GCC} -march=rv32im -mabi=ilp32 -print-libgcc-file-name
  OUTPUT_VARIABLE MEBOTS_RISCV_LIBGCC OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
set(MEBOTS_FIRMWARE_DIR ${PROJECT_BINARY_DIR}/firmware)
set(MEBOTS_FIRMWARE_SOURCE_DIR ${PROJECT_SOURCE_DIR}/fmu_soc/firmware)

# mebots_soc_board(<name> <board file>)
# Target <name>_headers: board.h for the firmware and board.hpp for device models in C++, in generated/<name>.
function(mebots_soc_board name file)
  get_filename_component(file ${file} ABSOLUTE)
  set(out ${PROJECT_BINARY_DIR}/generated/${name})
  file(MAKE_DIRECTORY ${out})
  add_custom_command(
    OUTPUT ${out}/board.h ${out}/board.hpp
    COMMAND mebots-boardgen ${file} --c ${out}/board.h --cpp ${out}/board.hpp
    DEPENDS mebots-boardgen ${file}
    COMMENT "Board headers ${name}"
    VERBATIM)
  add_custom_target(${name}_headers DEPENDS ${out}/board.h ${out}/board.hpp)
  set_target_properties(${name}_headers PROPERTIES MEBOTS_BOARD_FILE ${file})
endfunction()

# mebots_add_firmware(<name> SOURCES <file>... [DATA <file>...] [BOARD <name of mebots_soc_board>] [NO_CLUSTER])
# Compiles C and assembler sources, links them with the runtime of fmu_soc/firmware, and makes
# ${PROJECT_BINARY_DIR}/firmware/<name>.elf as target <name>_firmware. BOARD is the AI-deck when not said; NO_CLUSTER is
# for a board without one.
function(mebots_add_firmware name)
  cmake_parse_arguments(ARG "NO_CLUSTER" "BOARD" "SOURCES;DATA" ${ARGN})
  if(NOT ARG_BOARD)
    set(ARG_BOARD fmu_soc_board)
  endif()
  set(board_dir ${PROJECT_BINARY_DIR}/generated/${ARG_BOARD})
  get_target_property(board_file ${ARG_BOARD}_headers MEBOTS_BOARD_FILE)
  set(options -march=rv32imc_zicsr -mabi=ilp32 -mcmodel=medany -O2 -g -ffreestanding -ffunction-sections
      -fdata-sections -Wall -Wextra -Wpedantic -Wshadow -I${MEBOTS_FIRMWARE_SOURCE_DIR} -I${board_dir}
      -ffile-prefix-map=${PROJECT_BINARY_DIR}=. -ffile-prefix-map=${PROJECT_SOURCE_DIR}=.)
  if(MEBOTS_WARNINGS_AS_ERRORS)
    list(APPEND options -Werror)
  endif()

  # The order is that of the code in memory: another one costs other refills of the instruction cache.
  set(sources crt0.S console.c exit.c memory.c sleep.c trap.c)
  if(NOT ARG_NO_CLUSTER)
    list(PREPEND sources cluster.c cluster_start.S)
  endif()
  list(TRANSFORM sources PREPEND ${MEBOTS_FIRMWARE_SOURCE_DIR}/runtime/)
  foreach(source IN LISTS ARG_SOURCES)
    get_filename_component(source ${source} ABSOLUTE)
    list(APPEND sources ${source})
  endforeach()
  set(data)
  foreach(file IN LISTS ARG_DATA)
    get_filename_component(file ${file} ABSOLUTE)
    list(APPEND data ${file})
  endforeach()
  set(objects)
  foreach(source IN LISTS sources)
    file(RELATIVE_PATH object ${PROJECT_SOURCE_DIR} ${source})
    string(REPLACE "/" "_" object ${object})
    set(object ${MEBOTS_FIRMWARE_DIR}/${name}/${object}.o)
    if(source MATCHES "\\.c$")
      set(standard -std=c11)
      set(brought_in)
    else()
      set(standard)
      set(brought_in ${data})
    endif()
    file(RELATIVE_PATH shown ${PROJECT_SOURCE_DIR} ${source})
    add_custom_command(
      OUTPUT ${object}
      COMMAND ${CMAKE_COMMAND} -E make_directory ${MEBOTS_FIRMWARE_DIR}/${name}
      COMMAND ${MEBOTS_RISCV_GCC} ${options} ${standard} -MMD -MF ${object}.d -c ${source} -o ${object}
      DEPENDS ${source} ${ARG_BOARD}_headers ${brought_in}
      DEPFILE ${object}.d
      COMMENT "Firmware ${name}: ${shown}"
      VERBATIM)
    list(APPEND objects ${object})
  endforeach()

  set(script ${MEBOTS_FIRMWARE_DIR}/${name}/link.ld)
  set(elf ${MEBOTS_FIRMWARE_DIR}/${name}.elf)
  add_custom_command(
    OUTPUT ${elf} ${script}
    COMMAND ${MEBOTS_RISCV_GCC} -E -P -x assembler-with-cpp -include ${board_dir}/board.h
            ${MEBOTS_FIRMWARE_SOURCE_DIR}/runtime/link.ld.in -o ${script}
    COMMAND ${MEBOTS_RISCV_GCC} -march=rv32imc -mabi=ilp32 -nostdlib -Wl,--gc-sections -Wl,--fatal-warnings
            -T ${script} -Wl,-Map=${MEBOTS_FIRMWARE_DIR}/${name}.map ${objects} ${MEBOTS_RISCV_LIBGCC} -o ${elf}
    DEPENDS ${objects} ${MEBOTS_FIRMWARE_SOURCE_DIR}/runtime/link.ld.in ${ARG_BOARD}_headers ${board_file}
    COMMENT "Linking ${name}.elf"
    VERBATIM)
  add_custom_target(${name}_firmware ALL DEPENDS ${elf})
endfunction()

# mebots_soc_fmu(<name> BOARD <board file> FIRMWARE <name of mebots_add_firmware> [DEVICES <file>...])
# The chip with another board and another firmware inside: ${MEBOTS_FMU_DIR}/<name>.fmu, as target <name>_archive. Its
# variables are those of fmu_soc/description.json and of the board's devices. DEVICES are C++ sources with models of the
# board's own devices, where its file does not describe them wholly; they define mebots::soc::make_own_device.
function(mebots_soc_fmu name)
  cmake_parse_arguments(ARG "" "BOARD;FIRMWARE" "DEVICES" ${ARGN})
  set(devices ${PROJECT_SOURCE_DIR}/fmu_soc/src/devices/no_own_device.cpp)
  if(ARG_DEVICES)
    set(devices ${ARG_DEVICES})
  endif()
  get_filename_component(board ${ARG_BOARD} ABSOLUTE)
  get_filename_component(board_name ${board} NAME)
  mebots_add_fmu(${name}
    SOURCE_DIR ${PROJECT_SOURCE_DIR}/fmu_soc
    IDENTIFIER fmu_soc
    MODEL_SOURCES ${PROJECT_SOURCE_DIR}/fmu_soc/src/model.cpp ${devices}
    MODEL_LIBRARIES soc_platform
    MODEL_DEFINITIONS MEBOTS_SOC_BOARD="${board_name}" MEBOTS_SOC_FIRMWARE="${ARG_FIRMWARE}.elf"
    BOARD ${board}
    RESOURCE_FILES ${board} ${MEBOTS_FIRMWARE_DIR}/${ARG_FIRMWARE}.elf)
  add_dependencies(${name}_archive ${ARG_FIRMWARE}_firmware)
endfunction()
