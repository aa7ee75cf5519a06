# The packages of others, each found or refused with the remedy: what it is called on Debian and Ubuntu, and the
# script that installs it.

# kerf_missing(WHAT PACKAGE SECTION HINT...): fails because WHAT is missing.
function(kerf_missing what package section)
  message(FATAL_ERROR
          "kerf needs ${what}, which was not found. On Debian and Ubuntu:\n"
          "  scripts/setup ${section}      (all packages of this part of kerf)\n"
          "  apt install ${package}\n" ${ARGN})
endfunction()

macro(kerf_find_tbb what section hint)
  if(NOT TARGET TBB::tbb)
    find_package(TBB QUIET)
    if(NOT TARGET TBB::tbb)
      kerf_missing(${what} libtbb-dev ${section} ${hint})
    endif()
  endif()
endmacro()

# The library. A parent project may bring the first two as targets of its own.
macro(kerf_find_library_packages)
  set(KERF_THREAD_LIBRARY "")  # what a program links, too, that uses the static library
  if(KERF_THREADS STREQUAL "tbb")
    kerf_find_tbb("oneTBB" library "Without it: -DKERF_THREADS=std, or serial")
    set(KERF_THREAD_LIBRARY TBB::tbb)
  elseif(KERF_THREADS STREQUAL "std")
    find_package(Threads REQUIRED)
    set(KERF_THREAD_LIBRARY Threads::Threads)
  elseif(NOT KERF_THREADS STREQUAL "serial")
    message(FATAL_ERROR "KERF_THREADS is \"${KERF_THREADS}\", which is none of tbb, std and serial")
  endif()
  if(NOT TARGET hwy::hwy)
    find_package(hwy 1.0 QUIET)
    if(NOT TARGET hwy::hwy)
      kerf_missing("Highway 1.0 or newer" libhwy-dev library)
    endif()
  endif()
  find_path(KERF_XXHASH_INCLUDE xxhash.h DOC "The folder of xxhash.h, with which .kerf files are checked")
  if(NOT KERF_XXHASH_INCLUDE)
    kerf_missing("xxHash" libxxhash-dev library)
  endif()
endmacro()

# The tool. Without it the library needs none of these.
macro(kerf_find_tool_packages)
  set(KERF_WITHOUT_TOOL "The library alone, with three packages: cmake --preset library, or -DKERF_BUILD_TOOL=OFF")
  kerf_find_tbb("oneTBB, for its tool," build ${KERF_WITHOUT_TOOL})
  foreach(package CLI11=libcli11-dev fmt=libfmt-dev nlohmann_json=nlohmann-json3-dev PNG=libpng-dev ZLIB=zlib1g-dev
                  meshoptimizer=libmeshoptimizer-dev)
    string(REGEX MATCH "(.*)=(.*)" ignored ${package})
    set(name ${CMAKE_MATCH_1})
    set(debian ${CMAKE_MATCH_2})
    find_package(${name} QUIET)
    if(NOT ${name}_FOUND)
      kerf_missing("${name}, for its tool," ${debian} build ${KERF_WITHOUT_TOOL})
    endif()
  endforeach()
  find_path(KERF_DRACO_INCLUDE draco/compression/decode.h)
  find_library(KERF_DRACO draco)
  if(NOT KERF_DRACO_INCLUDE OR NOT KERF_DRACO)
    kerf_missing("Draco, for its tool," libdraco-dev build ${KERF_WITHOUT_TOOL})
  endif()
endmacro()

# The tests: sets `missing` to the packages that are not there, of which the first is told.
macro(kerf_find_test_packages missing)
  set(${missing} "")
  find_package(GTest QUIET)
  find_package(rapidcheck QUIET)  # properties
  if(POLICY CMP0167)
    cmake_policy(SET CMP0167 NEW)  # CMake 3.30 leaves it to Boost to say where it is
  endif()
  find_package(Boost QUIET)       # Multiprecision, over GMP: the exact oracles
  find_package(fmt QUIET)
  find_library(KERF_GMP gmp)
  foreach(package GTest=libgtest-dev rapidcheck=librapidcheck-dev Boost=libboost-dev fmt=libfmt-dev)
    string(REGEX MATCH "(.*)=(.*)" ignored ${package})
    if(NOT ${CMAKE_MATCH_1}_FOUND)
      list(APPEND ${missing} ${CMAKE_MATCH_2})
    endif()
  endforeach()
  if(NOT KERF_GMP)
    list(APPEND ${missing} libgmp-dev)
  endif()
  if(KERF_BUILD_TOOL)
    find_library(KERF_STB stb)  # reads pictures back, independently of libpng
    if(NOT KERF_STB)
      list(APPEND ${missing} libstb-dev)
    endif()
  endif()
  if(NOT CMAKE_CROSSCOMPILING)
    find_package(Python3 QUIET COMPONENTS Interpreter)  # reads the documents and runs what they show
    if(NOT Python3_FOUND)
      list(APPEND ${missing} python3)
    endif()
  endif()
endmacro()

# The micro-benchmarks.
macro(kerf_find_benchmark_packages missing)
  set(${missing} "")
  find_package(benchmark QUIET)
  if(NOT benchmark_FOUND)
    list(APPEND ${missing} libbenchmark-dev)
  endif()
endmacro()

# kerf_decide(VARIABLE WHAT MISSING...): AUTO becomes ON if nothing is missing and OFF, with a message, if something is;
# ON with something missing fails.
macro(kerf_decide variable what)
  set(packages ${ARGN})
  list(JOIN packages " " names)
  if(NOT packages)
    set(${variable} ON)
  elseif(${variable} STREQUAL "AUTO")
    message(STATUS "kerf: ${what} are left out for want of ${names}; scripts/setup test installs what they need")
    set(${variable} OFF)
  else()
    kerf_missing("more packages for its ${what}" "${names}" test "Without them: -D${variable}=OFF")
  endif()
endmacro()
