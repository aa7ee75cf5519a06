# Tests that each public header, included alone, tells a compiler of older C++ one thing: what to do.

add_test(NAME Headers.InOlderCppEachGivesOneErrorThatNamesTheRemedy
         COMMAND ${CMAKE_COMMAND} -DCXX=${CMAKE_CXX_COMPILER} -DINCLUDE_DIR=${PROJECT_SOURCE_DIR}/include
                 -DWORK_DIR=${PROJECT_BINARY_DIR}/older_cpp -P ${PROJECT_SOURCE_DIR}/cmake/TestOlderCpp.cmake)
