# Builds the library alone, installs it, and builds and runs examples/minimal against what was installed.
# Run with -P; KerfProjectTests.cmake sets the variables.

function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${ARGV}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

set(prefix ${WORK_DIR}/prefix)
file(REMOVE_RECURSE ${prefix} ${WORK_DIR}/example)
string(COMPARE EQUAL ${LINKAGE} Shared shared)
set(common -G ${GENERATOR} -DCMAKE_BUILD_TYPE=${BUILD_TYPE} -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_FLAGS=${CXX_FLAGS})

run(${CMAKE_COMMAND} -S ${SOURCE_DIR} -B ${WORK_DIR}/library ${common} -DBUILD_SHARED_LIBS=${shared}
    -DKERF_BUILD_TOOL=OFF -DKERF_BUILD_TESTS=OFF -DKERF_BUILD_BENCHMARKS=OFF -DKERF_BUILD_EXAMPLES=OFF)
run(${CMAKE_COMMAND} --build ${WORK_DIR}/library)
run(${CMAKE_COMMAND} --install ${WORK_DIR}/library --prefix ${prefix} --component library)

run(${CMAKE_COMMAND} -S ${SOURCE_DIR}/examples/minimal -B ${WORK_DIR}/example ${common} -DCMAKE_PREFIX_PATH=${prefix})
run(${CMAKE_COMMAND} --build ${WORK_DIR}/example)
run(${WORK_DIR}/example/minimal)
if(NOT output MATCHES "hit triangle 0 of mesh 0 at t = 2")
  message(FATAL_ERROR "the example printed: ${output}")
endif()
message("${output}")
