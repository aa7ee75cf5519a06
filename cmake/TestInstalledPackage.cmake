# Installs the library, and builds and runs examples/minimal and own_pool against what was installed. The library is that of the
# build in BINARY_DIR, or if that is not given one that is built here, alone, shared and with OPTIONS.
# Run with -P; KerfProjectTests.cmake sets the variables.

function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${ARGV}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

set(prefix ${WORK_DIR}/prefix)
file(REMOVE_RECURSE ${prefix} ${WORK_DIR}/example ${WORK_DIR}/own_pool ${WORK_DIR}/programs)
set(common -G ${GENERATOR} -DCMAKE_BUILD_TYPE=${BUILD_TYPE} -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_FLAGS=${CXX_FLAGS})

if(NOT BINARY_DIR)
  set(BINARY_DIR ${WORK_DIR}/library)
  separate_arguments(options UNIX_COMMAND "${OPTIONS}")
  run(${CMAKE_COMMAND} -S ${SOURCE_DIR} -B ${BINARY_DIR} ${common} -DBUILD_SHARED_LIBS=ON
      -DKERF_BUILD_TOOL=OFF -DKERF_BUILD_TESTS=OFF -DKERF_BUILD_BENCHMARKS=OFF -DKERF_BUILD_EXAMPLES=OFF
      -DKERF_BINDINGS_C=ON ${options})
  run(${CMAKE_COMMAND} --build ${BINARY_DIR})
endif()
foreach(component library development)
  run(${CMAKE_COMMAND} --install ${BINARY_DIR} --prefix ${prefix} --component ${component})
endforeach()

run(${CMAKE_COMMAND} -S ${SOURCE_DIR}/examples/minimal -B ${WORK_DIR}/example ${common} -DCMAKE_PREFIX_PATH=${prefix})
run(${CMAKE_COMMAND} --build ${WORK_DIR}/example)
run(${WORK_DIR}/example/minimal)
if(NOT output MATCHES "hit triangle 0 of mesh 0 at t = 2")
  message(FATAL_ERROR "the example printed: ${output}")
endif()
message("${output}")

# On a pool of threads of the program's own, whatever threads the library has. The package is found where CMake looks by
# itself, although the programs of the build come first in PATH.
run(${CMAKE_COMMAND} -E env "PATH=${BINARY_DIR}/bin:$ENV{PATH}" ${CMAKE_COMMAND} -S ${SOURCE_DIR}/examples/own_pool
    -B ${WORK_DIR}/own_pool ${common} -DCMAKE_INSTALL_PREFIX=${prefix})
run(${CMAKE_COMMAND} --build ${WORK_DIR}/own_pool)
run(${WORK_DIR}/own_pool/own_pool)
if(NOT output MATCHES "75000 of 100000 rays hit the floor")
  message(FATAL_ERROR "the example printed: ${output}")
endif()
message("${output}")

# In each language, static and shared.
run(${CMAKE_COMMAND} -S ${SOURCE_DIR}/tests/package -B ${WORK_DIR}/programs ${common} -DCMAKE_PREFIX_PATH=${prefix}
    -DKERF_FROM=find_package)
run(${CMAKE_COMMAND} --build ${WORK_DIR}/programs)
run(${CMAKE_CTEST_COMMAND} --test-dir ${WORK_DIR}/programs --no-tests=error --output-on-failure)
message("${output}")

# The same by pkg-config, in C++ and in C, by what has been installed and then moved.
file(REMOVE_RECURSE ${prefix}-moved)
file(RENAME ${prefix} ${prefix}-moved)
file(GLOB_RECURSE packages ${prefix}-moved/*/pkgconfig/*.pc)
find_program(PKG_CONFIG pkg-config REQUIRED)
separate_arguments(cxx_flags UNIX_COMMAND "${CXX_FLAGS}")
foreach(package ${packages})
  get_filename_component(folder ${package} DIRECTORY)
  get_filename_component(name ${package} NAME_WE)
  set(ENV{PKG_CONFIG_PATH} ${folder})
  run(${PKG_CONFIG} --cflags --libs ${name})
  separate_arguments(flags UNIX_COMMAND "${output}")
  set(program ${WORK_DIR}/program_${name})
  if(name STREQUAL "kerf_c")
    run(cc -std=c99 -pedantic -Werror ${SOURCE_DIR}/bindings/c/examples/first_hit/main.c -o ${program} ${flags})
    foreach(standard 11 17)
      run(${CXX} ${cxx_flags} -std=c++${standard} ${SOURCE_DIR}/tests/package/older_cpp.cpp -o ${program}_cpp${standard} ${flags})
    endforeach()
    set(expected "triangle 0 at t = 2")
  else()
    run(${CXX} ${cxx_flags} -std=c++20 ${SOURCE_DIR}/examples/minimal/main.cpp -o ${program} ${flags})
    set(expected "hit triangle 0 of mesh 0 at t = 2")
  endif()
  get_filename_component(libraries ${folder} DIRECTORY)
  file(GLOB programs ${program} ${program}_cpp*)
  foreach(program ${programs})
    run(${CMAKE_COMMAND} -E env LD_LIBRARY_PATH=${libraries} ${program})
    if(NOT output MATCHES "${expected}")
      message(FATAL_ERROR "the program of ${name} by pkg-config printed: ${output}")
    endif()
    message("${name}: ${output}")
  endforeach()
endforeach()
