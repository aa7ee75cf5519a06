# What the library adds to a static program. The bound is for the compilers of Linux on x86-64, with all instruction
# sets and as users link a small program.
set(KERF_MAX_PROGRAM_BYTES 700000)
if(BUILD_SHARED_LIBS OR KERF_LEAVE_OUT OR NOT CMAKE_BUILD_TYPE STREQUAL "Release" OR
   NOT CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64" OR NOT CMAKE_SYSTEM_NAME STREQUAL "Linux")
  return()
endif()
foreach(name nothing rays)
  add_executable(kerf_size_${name} ${PROJECT_SOURCE_DIR}/tests/size/${name}.cpp)
  target_link_libraries(kerf_size_${name} PRIVATE kerf_warnings)
  target_link_options(kerf_size_${name} PRIVATE LINKER:--gc-sections -s)
endforeach()
target_link_libraries(kerf_size_rays PRIVATE kerf)
add_test(NAME Package.AStaticProgramThatTracesRaysGrowsBy700KilobytesAtMost
         COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:kerf_size_rays> -DWITHOUT=$<TARGET_FILE:kerf_size_nothing>
                 -DMAX_BYTES=${KERF_MAX_PROGRAM_BYTES} -P ${PROJECT_SOURCE_DIR}/cmake/TestProgramSize.cmake)
