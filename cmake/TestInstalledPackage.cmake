# Installs the library, and builds and runs examples/minimal against what was installed. The library is that of the
# build in BINARY_DIR, or if that is not given one that is built here, alone and shared.
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
set(common -G ${GENERATOR} -DCMAKE_BUILD_TYPE=${BUILD_TYPE} -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_FLAGS=${CXX_FLAGS})

if(NOT BINARY_DIR)
  set(BINARY_DIR ${WORK_DIR}/library)
  run(${CMAKE_COMMAND} -S ${SOURCE_DIR} -B ${BINARY_DIR} ${common} -DBUILD_SHARED_LIBS=ON
      -DKERF_BUILD_TOOL=OFF -DKERF_BUILD_TESTS=OFF -DKERF_BUILD_BENCHMARKS=OFF -DKERF_BUILD_EXAMPLES=OFF)
  run(${CMAKE_COMMAND} --build ${BINARY_DIR})
endif()
run(${CMAKE_COMMAND} --install ${BINARY_DIR} --prefix ${prefix} --component library)

run(${CMAKE_COMMAND} -S ${SOURCE_DIR}/examples/minimal -B ${WORK_DIR}/example ${common} -DCMAKE_PREFIX_PATH=${prefix})
run(${CMAKE_COMMAND} --build ${WORK_DIR}/example)
run(${WORK_DIR}/example/minimal)
if(NOT output MATCHES "hit triangle 0 of mesh 0 at t = 2")
  message(FATAL_ERROR "the example printed: ${output}")
endif()
message("${output}")
