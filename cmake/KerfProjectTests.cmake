# Tests of the project as a whole, beside those of its code.

add_test(NAME Architecture.RoomsIncludeOnlyWhatTheyMay COMMAND ${PROJECT_SOURCE_DIR}/scripts/check-includes)
include(KerfDocuments)
include(KerfRefusedTypes)

# An installed copy, found and used as a stranger would.
function(kerf_test_package name)
  add_test(
    NAME ${name}
    COMMAND
      ${CMAKE_COMMAND} -DSOURCE_DIR=${PROJECT_SOURCE_DIR} -DWORK_DIR=${PROJECT_BINARY_DIR}/package/${name}
      -DCXX=${CMAKE_CXX_COMPILER} -DCXX_FLAGS=${CMAKE_CXX_FLAGS} -DBUILD_TYPE=${CMAKE_BUILD_TYPE}
      -DGENERATOR=${CMAKE_GENERATOR} ${ARGN} -P ${PROJECT_SOURCE_DIR}/cmake/TestInstalledPackage.cmake)
  set_tests_properties(${name} PROPERTIES TIMEOUT 900)
endfunction()

if(KERF_TEST_PACKAGE)
  if(NOT BUILD_SHARED_LIBS)
    kerf_test_package(Package.StaticLibraryIsFoundAndUsed -DBINARY_DIR=${PROJECT_BINARY_DIR})
  endif()
  kerf_test_package(Package.SharedLibraryIsFoundAndUsed)
endif()
