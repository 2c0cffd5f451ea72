# SPDX-License-Identifier: Apache-2.0
# Writes the exports of a DLL to OUT, in the linker's format: the functions in OBJECTS that begin with PREFIX. NM is the
# program that lists symbols.
execute_process(COMMAND ${NM} --defined-only --extern-only ${OBJECTS} OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL " T ${PREFIX}[A-Za-z0-9_]+" names "${symbols}")
list(TRANSFORM names REPLACE "^ T " "")
list(SORT names)
list(JOIN names "\n" names)
file(WRITE ${OUT} "EXPORTS\n${names}\n")
