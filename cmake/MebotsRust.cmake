# SPDX-License-Identifier: Apache-2.0
#
# Rust (no_std) in firmware. Finds a compiler with the library `core` for RV32IMC, or builds this library from the
# compiler's sources.

set(mebots_rust_target riscv32imc-unknown-none-elf)

# mebots_find_rustc()
# Sets MEBOTS_RUSTC in the cache to a Rust compiler, and MEBOTS_RUST_SYSROOT to its folder of libraries. The compiler must have `core` for RV32IMC
# (rustup target add riscv32imc-unknown-none-elf) or the sources of `core` (Debian's rust-src). Stops with an error if no such compiler is found.
function(mebots_find_rustc)
  if(MEBOTS_RUSTC AND MEBOTS_RUST_SYSROOT)
    return()
  endif()
  set(candidates ${MEBOTS_RUSTC})
  if(NOT candidates)
    find_program(in_path rustc NO_CACHE)
    set(candidates ${in_path} /usr/bin/rustc)  # rustup's compiler often precedes Debian's
  endif()
  foreach(candidate IN LISTS candidates)
    execute_process(COMMAND ${candidate} --print sysroot
      OUTPUT_VARIABLE sysroot OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE result)
    if(result EQUAL 0 AND (IS_DIRECTORY ${sysroot}/lib/rustlib/${mebots_rust_target}/lib OR
                           EXISTS ${sysroot}/lib/rustlib/src/rust/library/core/src/lib.rs))
      set(MEBOTS_RUSTC ${candidate} CACHE FILEPATH "Rust compiler for the firmware" FORCE)
      set(MEBOTS_RUST_SYSROOT ${sysroot} CACHE INTERNAL "Folder of the Rust compiler's libraries")
      return()
    endif()
  endforeach()
  message(FATAL_ERROR "no Rust compiler with the library core for RV32IMC: install Debian's rustc and rust-src, or call "
                      "rustup target add ${mebots_rust_target}. MEBOTS_RUSTC names another compiler")
endfunction()

# mebots_rust_library(<variable>)
# Adds the target mebots_rust_core, and returns the compiler options for crates that use `core`. If the compiler has
# only the sources of `core`, the target builds it (about ten seconds). The crate compiler_builtins is empty, because
# libgcc and the firmware's runtime define its functions.
function(mebots_rust_library result)
  mebots_find_rustc()
  if(IS_DIRECTORY ${MEBOTS_RUST_SYSROOT}/lib/rustlib/${mebots_rust_target}/lib)
    if(NOT TARGET mebots_rust_core)
      add_custom_target(mebots_rust_core)
    endif()
    set(${result} "" PARENT_SCOPE)
    return()
  endif()
  set(folder ${PROJECT_BINARY_DIR}/rust)
  set(${result} --sysroot ${folder} PARENT_SCOPE)
  if(TARGET mebots_rust_core)
    return()
  endif()
  set(core ${MEBOTS_RUST_SYSROOT}/lib/rustlib/src/rust/library/core)
  file(STRINGS ${core}/Cargo.toml edition REGEX "^edition *=")
  string(REGEX REPLACE "[^0-9]" "" edition "${edition}")
  set(libraries ${folder}/lib/rustlib/${mebots_rust_target}/lib)
  file(MAKE_DIRECTORY ${libraries})
  file(CONFIGURE OUTPUT ${folder}/compiler_builtins.rs CONTENT
    "#![no_std]\n#![feature(compiler_builtins)]\n#![allow(internal_features)]\n#![compiler_builtins]\n")
  # Permits unstable features, which the standard libraries use.
  set(compile ${CMAKE_COMMAND} -E env RUSTC_BOOTSTRAP=1 ${MEBOTS_RUSTC} --target ${mebots_rust_target} --crate-type rlib
      -C panic=abort -C opt-level=3 -Z force-unstable-if-unmarked --cap-lints allow --sysroot ${folder} --out-dir ${libraries})
  add_custom_command(
    OUTPUT ${libraries}/libcompiler_builtins.rlib
    COMMAND ${compile} --edition=${edition} --crate-name core ${core}/src/lib.rs
    COMMAND ${compile} --edition=2021 --crate-name compiler_builtins ${folder}/compiler_builtins.rs
    DEPENDS ${core}/src/lib.rs ${folder}/compiler_builtins.rs
    COMMENT "Rust's library core for the firmware"
    VERBATIM)
  add_custom_target(mebots_rust_core DEPENDS ${libraries}/libcompiler_builtins.rlib)
endfunction()
