# Runs PROGRAM, and compares how much larger it is than WITHOUT with MAX_BYTES. Run with -P; KerfProgramSize.cmake
# sets the variables.
execute_process(COMMAND ${PROGRAM} OUTPUT_VARIABLE output RESULT_VARIABLE status)
if(NOT status EQUAL 0 OR NOT output STREQUAL "1 1 1 1 1\n")
  message(FATAL_ERROR "${PROGRAM} printed \"${output}\" and ended with ${status}")
endif()
file(SIZE ${PROGRAM} with)
file(SIZE ${WITHOUT} without)
math(EXPR bytes "${with} - ${without}")
message("kerf takes ${bytes} bytes of this program; ${MAX_BYTES} are allowed")
if(bytes GREATER MAX_BYTES)
  message(FATAL_ERROR "too large: nm -C -S --size-sort, on a program that is linked without -s, tells what grew")
endif()
