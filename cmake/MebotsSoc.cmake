# SPDX-License-Identifier: Apache-2.0
#
# Functions for a board: headers, firmware, and the chip's FMU for this board. To add a board with its sensors, a folder
# calls mebots_soc_board(), mebots_add_firmware() and mebots_soc_fmu(). No other file must be changed.

# These functions can be used in this tree and after find_package(mebots), which sets MEBOTS_ROOT. This folder contains
# the chip's sources and the firmware's runtime and drivers in fmu_soc/, and the boards in configs/boards/.
if(NOT MEBOTS_ROOT)
  get_filename_component(MEBOTS_ROOT ${CMAKE_CURRENT_LIST_DIR}/.. ABSOLUTE)
endif()
set_property(GLOBAL PROPERTY MEBOTS_ROOT ${MEBOTS_ROOT})
include(${CMAKE_CURRENT_LIST_DIR}/BoardWith.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/MebotsRust.cmake)

# mebots_find_riscv_gcc()
# Sets MEBOTS_RISCV_GCC and MEBOTS_RISCV_LIBGCC in the cache. Stops with an error if the compiler is missing.
function(mebots_find_riscv_gcc)
  find_program(MEBOTS_RISCV_GCC riscv64-unknown-elf-gcc DOC "Bare-metal RISC-V C compiler for the firmware")
  if(NOT MEBOTS_RISCV_GCC)
    message(FATAL_ERROR "riscv64-unknown-elf-gcc is missing: install Debian's gcc-riscv64-unknown-elf, or build "
                        "without the chip (-DMEBOTS_CHIP=OFF)")
  endif()
  if(MEBOTS_RISCV_LIBGCC)
    return()
  endif()
  # Uses the library for rv32im, because GCC has none for rv32imc. The -march for linking has no _zicsr: GCC 12 would
  # otherwise not find its 32-bit libraries.
  execute_process(
    COMMAND ${MEBOTS_RISCV_GCC} -march=rv32im -mabi=ilp32 -print-libgcc-file-name
    OUTPUT_VARIABLE libgcc OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  set(MEBOTS_RISCV_LIBGCC ${libgcc} CACHE INTERNAL "GCC's own library for rv32im")
endfunction()

# mebots_require_picolibc()
# Stops with the name of the missing package if the RISC-V compiler has no picolibc.
function(mebots_require_picolibc)
  execute_process(COMMAND ${MEBOTS_RISCV_GCC} --specs=picolibc.specs -E -x c /dev/null
    OUTPUT_QUIET ERROR_QUIET RESULT_VARIABLE result)
  if(result)
    message(FATAL_ERROR "picolibc is missing: install Debian's picolibc-riscv64-unknown-elf, or remove C_LIBRARY")
  endif()
endfunction()

# mebots_soc_board(<name> <board file>)
# Adds the target <name>_headers: board.h for firmware and board.hpp for device models in C++, both in generated/<name>.
function(mebots_soc_board name file)
  get_filename_component(file ${file} ABSOLUTE)
  set(out ${PROJECT_BINARY_DIR}/generated/${name})
  file(MAKE_DIRECTORY ${out})
  add_custom_command(
    OUTPUT ${out}/board.h ${out}/board.hpp
    COMMAND mebots::mebots-boardgen ${file} --c ${out}/board.h --cpp ${out}/board.hpp
    DEPENDS mebots::mebots-boardgen ${file}
    COMMENT "Board headers ${name}"
    VERBATIM)
  add_custom_target(${name}_headers DEPENDS ${out}/board.h ${out}/board.hpp)
  set_target_properties(${name}_headers PROPERTIES MEBOTS_BOARD_FILE ${file} MEBOTS_BOARD_DIR ${out})
endfunction()

# mebots_add_firmware(<name> SOURCES <file>... [DRIVERS <name>...] [DATA <file>...] [BOARD <name of mebots_soc_board>]
#   [NO_CLUSTER] [C_LIBRARY] [OPTIONS <compiler option>...] [LINKER_SCRIPT <file>])
# Compiles C, C++ (.cpp: C++20 without exceptions, RTTI and heap) and assembler sources, and links them with the runtime
# of fmu_soc/firmware. Builds ${PROJECT_BINARY_DIR}/firmware/<name>.elf as target <name>_firmware. DRIVERS are names in
# fmu_soc/firmware/drivers. DATA are files that assembler sources include. The default BOARD is the AI-deck. NO_CLUSTER
# is for a board without a cluster. C_LIBRARY links picolibc (Debian's picolibc-riscv64-unknown-elf): printf(),
# malloc(), <math.h> on the fabric controller (fmu_soc/firmware/runtime/c_library.c). On a board with GAP8's own event
# unit, files of fmu_soc/firmware/gap8 replace files with the same names. OPTIONS follow the standard options, so that
# -Os or -O3 overrides -O2. LINKER_SCRIPT replaces the runtime's script (firmware/runtime/link.ld.in), and must define
# the same symbols; the C preprocessor inserts the board's memory map. If the board's `isa` begins with rv32imafc, the
# program uses the core's floats (-mabi=ilp32f). A .rs file is the root of a crate in Rust 2021 without its standard
# library (MebotsRust.cmake); OPTIONS do not apply to it.
function(mebots_add_firmware name)
  cmake_parse_arguments(ARG "NO_CLUSTER;C_LIBRARY" "BOARD;LINKER_SCRIPT" "SOURCES;DRIVERS;DATA;OPTIONS" ${ARGN})
  mebots_find_riscv_gcc()
  get_property(root GLOBAL PROPERTY MEBOTS_ROOT)
  set(firmware_dir ${root}/fmu_soc/firmware)
  set(out_dir ${PROJECT_BINARY_DIR}/firmware)
  if(NOT ARG_BOARD)
    set(ARG_BOARD fmu_soc_board)
    if(NOT TARGET fmu_soc_board_headers)
      mebots_soc_board(fmu_soc_board ${root}/configs/boards/ai_deck.json)
    endif()
  endif()
  get_target_property(board_dir ${ARG_BOARD}_headers MEBOTS_BOARD_DIR)
  get_target_property(board_file ${ARG_BOARD}_headers MEBOTS_BOARD_FILE)
  # On a board with GAP8's own devices, files of firmware/gap8 replace files with the same names.
  set(overlay)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${board_file})
  file(READ ${board_file} board_text)
  if(board_text MATCHES "\"kind\"[ \t\r\n]*:[ \t\r\n]*\"gap8_event_unit\"")
    set(overlay ${firmware_dir}/gap8)
  endif()
  # If the board's core has floating-point registers, uses floating-point instructions, and passes floats in these
  # registers.
  set(isa rv32imc)
  set(abi ilp32)
  set(libgcc ${MEBOTS_RISCV_LIBGCC})
  if(board_text MATCHES "\"isa\"[ \t\r\n]*:[ \t\r\n]*\"rv32imafc")
    set(isa rv32imafc)
    set(abi ilp32f)
    execute_process(COMMAND ${MEBOTS_RISCV_GCC} -march=${isa} -mabi=${abi} -print-libgcc-file-name
      OUTPUT_VARIABLE libgcc OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  endif()
  set(options -march=${isa}_zicsr -mabi=${abi} -mcmodel=medany -O2 -g -ffreestanding -ffunction-sections
      -fdata-sections -Wall -Wextra -Wpedantic -Wshadow
      -ffile-prefix-map=${root}=. -ffile-prefix-map=${PROJECT_SOURCE_DIR}=. -ffile-prefix-map=${PROJECT_BINARY_DIR}=.)  # the last one that fits counts
  foreach(folder ${overlay} ${firmware_dir} ${board_dir})
    list(APPEND options -I${folder})
  endforeach()
  if(MEBOTS_WARNINGS_AS_ERRORS)
    list(APPEND options -Werror)
  endif()
  set(of_layout)
  set(link_with -nostdlib)
  set(libraries ${libgcc})
  if(ARG_C_LIBRARY)
    mebots_require_picolibc()
    list(APPEND options --specs=picolibc.specs -DWITH_C_LIBRARY)
    set(of_layout -DWITH_C_LIBRARY)
    set(link_with --specs=picolibc.specs -nostartfiles)
    set(libraries)  # those of GCC and picolibc that the specs name
  endif()
  list(APPEND options ${ARG_OPTIONS})
  set(script_source ${firmware_dir}/runtime/link.ld.in)
  if(ARG_LINKER_SCRIPT)
    get_filename_component(script_source ${ARG_LINKER_SCRIPT} ABSOLUTE)
  endif()

  # The order of the sources determines the order of the code in memory, and therefore the number of instruction cache
  # refills.
  set(sources crt0.S console.c exit.c memory.c sleep.c trap.c)
  if(ARG_C_LIBRARY)
    list(APPEND sources c_library.c)
  endif()
  if(NOT ARG_NO_CLUSTER)
    list(PREPEND sources cluster.c cluster_start.S)
  endif()
  if(overlay)
    list(APPEND sources chip.c soc_events.c uart.c vectors.S)
    if(NOT ARG_NO_CLUSTER)
      list(APPEND sources dma.c)
    endif()
  endif()
  # Calls constructors before main() only in programs with C++, so that the code and the cycles of other programs do not
  # change.
  if(ARG_SOURCES MATCHES "\\.cpp(;|$)")
    list(APPEND sources cxx.cpp)
    list(APPEND options -DWITH_CONSTRUCTORS)
  endif()
  list(TRANSFORM sources PREPEND ${firmware_dir}/runtime/)
  foreach(source IN LISTS ARG_SOURCES)
    get_filename_component(source ${source} ABSOLUTE)
    list(APPEND sources ${source})
  endforeach()
  foreach(driver IN LISTS ARG_DRIVERS)
    list(APPEND sources ${firmware_dir}/drivers/${driver}.c)
  endforeach()
  if(overlay)
    set(chosen)
    foreach(source IN LISTS sources)
      string(REPLACE ${firmware_dir}/ ${overlay}/ instead ${source})
      if(EXISTS ${instead})
        set(source ${instead})
      endif()
      list(APPEND chosen ${source})
    endforeach()
    set(sources ${chosen})
  endif()
  set(data)
  foreach(file IN LISTS ARG_DATA)
    get_filename_component(file ${file} ABSOLUTE)
    list(APPEND data ${file})
  endforeach()
  set(objects)
  set(crates)
  foreach(source IN LISTS sources)
    # Derives unique names of objects from the sources' paths in the project, or in MEbots.
    file(RELATIVE_PATH shown ${PROJECT_SOURCE_DIR} ${source})
    if(shown MATCHES "^\\.\\./")
      file(RELATIVE_PATH shown ${root} ${source})
    endif()
    string(REPLACE "/" "_" object ${shown})
    set(object ${out_dir}/${name}/${object}.o)
    if(source MATCHES "\\.rs$")
      if(abi STREQUAL "ilp32f")
        message(FATAL_ERROR "${shown}: Rust has no target with the floats of this board's core: use a board without them, or write this part in C")
      endif()
      mebots_rust_library(of_core)
      get_filename_component(crate ${source} NAME_WE)
      string(REPLACE - _ crate ${crate})
      set(object ${out_dir}/${name}/lib${crate}.a)
      add_custom_command(
        OUTPUT ${object} ${out_dir}/${name}/${crate}.d  # rustc's file of dependencies names itself as an output
        COMMAND ${CMAKE_COMMAND} -E make_directory ${out_dir}/${name}
        COMMAND ${MEBOTS_RUSTC} ${of_core} --target ${mebots_rust_target} --edition=2021 --crate-type staticlib --crate-name ${crate}
                -C panic=abort -C opt-level=2 -C lto=fat -g --remap-path-prefix ${PROJECT_SOURCE_DIR}=.
                --emit=link,dep-info --out-dir ${out_dir}/${name} ${source}
        DEPENDS ${source} mebots_rust_core
        DEPFILE ${out_dir}/${name}/${crate}.d
        COMMENT "Firmware ${name}: ${shown}"
        VERBATIM)
      list(APPEND crates ${object})
      continue()
    endif()
    set(compiler ${MEBOTS_RISCV_GCC})
    set(brought_in)
    if(source MATCHES "\\.c$")
      set(standard -std=c11)
    elseif(source MATCHES "\\.cpp$")
      string(REGEX REPLACE "gcc$" "g++" compiler ${MEBOTS_RISCV_GCC})
      set(standard -std=c++20 -fno-exceptions -fno-rtti -fno-threadsafe-statics -fno-use-cxa-atexit -fno-asynchronous-unwind-tables)
    else()
      set(standard "-Wa,--debug-prefix-map=${root}=." "-Wa,--debug-prefix-map=${PROJECT_SOURCE_DIR}=." "-Wa,--debug-prefix-map=${PROJECT_BINARY_DIR}=.")
      set(brought_in ${data})
    endif()
    add_custom_command(
      OUTPUT ${object}
      COMMAND ${CMAKE_COMMAND} -E make_directory ${out_dir}/${name}
      COMMAND ${compiler} ${options} ${standard} -MMD -MF ${object}.d -c ${source} -o ${object}
      DEPENDS ${source} ${ARG_BOARD}_headers ${brought_in}
      DEPFILE ${object}.d
      COMMENT "Firmware ${name}: ${shown}"
      VERBATIM)
    list(APPEND objects ${object})
  endforeach()

  set(script ${out_dir}/${name}/link.ld)
  set(elf ${out_dir}/${name}.elf)
  add_custom_command(
    OUTPUT ${elf} ${script}
    COMMAND ${MEBOTS_RISCV_GCC} -E -P -x assembler-with-cpp ${of_layout} -include ${board_dir}/board.h
            ${script_source} -o ${script}
    COMMAND ${MEBOTS_RISCV_GCC} -march=${isa} -mabi=${abi} ${link_with} -Wl,--gc-sections -Wl,--fatal-warnings
            -T ${script} -Wl,-Map=${out_dir}/${name}.map ${objects} ${crates} ${libraries} -o ${elf}
    DEPENDS ${objects} ${crates} ${script_source} ${ARG_BOARD}_headers ${board_file}
    COMMENT "Linking ${name}.elf"
    VERBATIM)
  add_custom_target(${name}_firmware ALL DEPENDS ${elf})
  set_target_properties(${name}_firmware PROPERTIES MEBOTS_ELF ${elf} MEBOTS_BOARD_FILE ${board_file})
endfunction()

# mebots_add_flight_controller(<name> SOURCES <file>... [BOARD <name of mebots_soc_board>] [OPTIONS <compiler option>...])
# Builds a flight controller as firmware <name>. SOURCES define the controller (fmu_soc/firmware/flight/controller.h).
# Sensors, estimator, set-points and loop are those of fmu_soc/firmware/flight. The default BOARD is
# configs/boards/flight_controller.json.
function(mebots_add_flight_controller name)
  cmake_parse_arguments(ARG "" "BOARD" "SOURCES;OPTIONS" ${ARGN})
  get_property(root GLOBAL PROPERTY MEBOTS_ROOT)
  if(NOT ARG_BOARD)
    set(ARG_BOARD flight_controller)
    if(NOT TARGET flight_controller_headers)
      mebots_soc_board(flight_controller ${root}/configs/boards/flight_controller.json)
    endif()
  endif()
  set(flight estimator.c goal.c main.c)
  set(drivers imu)
  # On a board with a UART, the flight controller receives its set-points by UART.
  get_target_property(board_file ${ARG_BOARD}_headers MEBOTS_BOARD_FILE)
  mebots_board_has_companion(has_companion ${board_file})
  if(has_companion)
    list(APPEND flight companion.c)
    list(APPEND drivers setpoint_frame)
  endif()
  list(TRANSFORM flight PREPEND ${root}/fmu_soc/firmware/flight/)
  mebots_add_firmware(${name} BOARD ${ARG_BOARD} NO_CLUSTER C_LIBRARY SOURCES ${flight} ${ARG_SOURCES} DRIVERS ${drivers}
    OPTIONS -fno-math-errno -ffp-contract=off ${ARG_OPTIONS})
endfunction()

# mebots_device_library(<name> SOURCES <file>...)
# Builds a library of device kinds in C++ (mebots/soc/device_kind.hpp) as target <name>_devices:
# ${PROJECT_BINARY_DIR}/devices/<name>.so. A board lists this file under "libraries".
function(mebots_device_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES" ${ARGN})
  add_library(${name}_devices MODULE ${ARG_SOURCES})
  mebots_target(${name}_devices)
  set_target_properties(${name}_devices PROPERTIES PREFIX "" OUTPUT_NAME ${name}
    LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/devices)
  target_link_libraries(${name}_devices PRIVATE mebots::interface)
  if(TARGET soc_files)
    target_include_directories(${name}_devices PRIVATE $<TARGET_PROPERTY:soc_files,INTERFACE_INCLUDE_DIRECTORIES>)
  endif()
  # Includes a copy of the C++ library, as in an FMU, so that the library runs on the same machines as an FMU.
  if(NOT MEBOTS_SANITIZE)
    target_link_options(${name}_devices PRIVATE -static-libstdc++ -static-libgcc -Wl,-z,defs)
  endif()
endfunction()

# mebots_soc_fmu(<name> BOARD <board file> [FIRMWARE <name of mebots_add_firmware>...] [DEVICES <name of mebots_device_library>...]
#   [FMI <version>...])
# Builds the chip's FMU with another board and other firmware as target <name>_archive: ${MEBOTS_FMU_DIR}/<name>.fmu.
# The parameter `firmware` selects the program; the default is the first FIRMWARE. Without FIRMWARE, this parameter must
# be the path of a program. The FMU's variables are those of fmu_soc/description.json and of the board's devices. The
# archive contains the libraries DEVICES, which the board lists. FMI is as in mebots_add_fmu(); the default is 2.
function(mebots_soc_fmu name)
  cmake_parse_arguments(ARG "" "BOARD" "FIRMWARE;DEVICES;FMI" ${ARGN})
  if(NOT ARG_FMI)
    set(ARG_FMI 2)
  endif()
  set(archives ${name}_archive)
  if("2" IN_LIST ARG_FMI AND "3" IN_LIST ARG_FMI)
    list(APPEND archives ${name}_fmi3_archive)
  endif()
  set(first_program)
  if(ARG_FIRMWARE)
    list(GET ARG_FIRMWARE 0 first_program)
    string(APPEND first_program .elf)
  endif()
  list(TRANSFORM ARG_FIRMWARE REPLACE "(.+)" "${PROJECT_BINARY_DIR}/firmware/\\1.elf" OUTPUT_VARIABLE programs)
  get_property(root GLOBAL PROPERTY MEBOTS_ROOT)
  set(libraries)
  foreach(library IN LISTS ARG_DEVICES)
    list(APPEND libraries ${PROJECT_BINARY_DIR}/devices/${library}.so)
  endforeach()
  get_filename_component(board ${ARG_BOARD} ABSOLUTE)
  get_filename_component(board_name ${board} NAME)
  mebots_add_fmu(${name}
    SOURCE_DIR ${root}/fmu_soc
    IDENTIFIER fmu_soc
    FMI ${ARG_FMI}
    MODEL_SOURCES ${root}/fmu_soc/src/fmu/model.cpp ${root}/fmu_soc/src/fmu/variable_fields.cpp
    MODEL_LIBRARIES mebots::soc_platform
    MODEL_DEFINITIONS MEBOTS_SOC_BOARD="${board_name}" MEBOTS_SOC_FIRMWARE="${first_program}"
    LINKED_IN /usr/include/xbyak/xbyak.h ${MEBOTS_RISCV_LIBGCC}
    BOARD ${board}
    RESOURCE_FILES ${board} ${programs} ${libraries})
  foreach(archive IN LISTS archives)
    foreach(firmware IN LISTS ARG_FIRMWARE)
      add_dependencies(${archive} ${firmware}_firmware)
    endforeach()
    foreach(library IN LISTS ARG_DEVICES)
      add_dependencies(${archive} ${library}_devices)
    endforeach()
  endforeach()
endfunction()

# mebots_run_firmware(<target> FIRMWARE <name of mebots_add_firmware> [DEVICES <name of mebots_device_library>...]
#   [OPTIONS <option of mebots-soc run>...])
# `cmake --build <folder> --target <target>` runs the firmware on its board without an FMU. DEVICES is as in
# mebots_soc_fmu().
function(mebots_run_firmware target)
  cmake_parse_arguments(ARG "" "FIRMWARE" "DEVICES;OPTIONS" ${ARGN})
  get_target_property(elf ${ARG_FIRMWARE}_firmware MEBOTS_ELF)
  get_target_property(board ${ARG_FIRMWARE}_firmware MEBOTS_BOARD_FILE)
  set(devices)
  if(ARG_DEVICES)
    set(devices --devices ${PROJECT_BINARY_DIR}/devices)
  endif()
  list(TRANSFORM ARG_DEVICES APPEND _devices OUTPUT_VARIABLE libraries)
  add_custom_target(${target}
    COMMAND mebots::mebots-soc run ${elf} --board ${board} ${devices} ${ARG_OPTIONS}
    DEPENDS ${ARG_FIRMWARE}_firmware ${libraries}
    USES_TERMINAL VERBATIM)
endfunction()

# mebots_run_mission(<target> CONFIG <file> [FMUS <name of mebots_add_fmu or mebots_soc_fmu>...] [OPTIONS <option of mebots run>...])
# `cmake --build <folder> --target <target>` runs a config. The config contains the names of this project's FMUs without
# a path.
function(mebots_run_mission target)
  cmake_parse_arguments(ARG "" "CONFIG" "FMUS;OPTIONS" ${ARGN})
  get_filename_component(config ${ARG_CONFIG} ABSOLUTE)
  list(TRANSFORM ARG_FMUS APPEND _archive)
  add_custom_target(${target}
    COMMAND ${CMAKE_COMMAND} -E env MEBOTS_FMU_PATH=${PROJECT_BINARY_DIR}/fmus $<TARGET_FILE:mebots::mebots> run ${config} ${ARG_OPTIONS}
    DEPENDS ${ARG_FMUS}
    WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}
    USES_TERMINAL VERBATIM)
endfunction()
