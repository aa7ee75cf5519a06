# Tests that what kerf would read as something else does not compile, and that the compiler names the remedy.

function(kerf_refused_type name case message)
  add_test(NAME RefusedTypes.${name}
           COMMAND ${CMAKE_CXX_COMPILER} -std=c++20 -fsyntax-only -I${PROJECT_SOURCE_DIR}/include -DKERF_CASE=${case}
                   ${PROJECT_SOURCE_DIR}/tests/compile/refused_types.cpp)
  if(message STREQUAL "")
    return()
  endif()
  set_tests_properties(RefusedTypes.${name} PROPERTIES PASS_REGULAR_EXPRESSION "${message}")
endfunction()

kerf_refused_type(RightOnesCompile 0 "")
kerf_refused_type(DoublesInAMeshOfFloats 1 "copy them to floats")
kerf_refused_type(IndicesOf64Bits 2 "copy them to .*32-bit indices")
kerf_refused_type(Quadrilaterals 3 "not three floats, or three 32-bit indices")
kerf_refused_type(Temporaries 4 "keep it in a variable")
kerf_refused_type(AnAddressOfDoubles 5 "an address of what is not floats")
