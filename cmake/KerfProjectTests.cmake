# Tests of the project as a whole, beside those of its code.

add_test(NAME Architecture.RoomsIncludeOnlyWhatTheyMay COMMAND ${PROJECT_SOURCE_DIR}/scripts/check-includes)

# An installed copy, found and used as a stranger would: once as a static, once as a shared library.
if(KERF_TEST_PACKAGE)
  foreach(linkage Static Shared)
    add_test(
      NAME Package.${linkage}LibraryIsFoundAndUsed
      COMMAND
        ${CMAKE_COMMAND} -DLINKAGE=${linkage} -DSOURCE_DIR=${PROJECT_SOURCE_DIR}
        -DWORK_DIR=${PROJECT_BINARY_DIR}/package/${linkage} -DCXX=${CMAKE_CXX_COMPILER} -DCXX_FLAGS=${CMAKE_CXX_FLAGS}
        -DBUILD_TYPE=${CMAKE_BUILD_TYPE} -DGENERATOR=${CMAKE_GENERATOR} -P
        ${CMAKE_CURRENT_LIST_DIR}/TestInstalledPackage.cmake)
    set_tests_properties(Package.${linkage}LibraryIsFoundAndUsed PROPERTIES TIMEOUT 900)
  endforeach()
endif()
