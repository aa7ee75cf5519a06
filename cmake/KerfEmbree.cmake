# Embree 3 or 4, which `kerf bench` measures kerf beside. Where neither is installed the tool says that it is absent.
option(KERF_EMBREE "Look for Embree, to measure kerf beside it" ON)

if(KERF_EMBREE)
  find_package(embree QUIET)
endif()

# Gives `target` the peer, or its absence.
function(kerf_link_embree target)
  if(TARGET embree AND EMBREE_VERSION_MAJOR GREATER_EQUAL 3)
    message(STATUS "Embree ${EMBREE_VERSION} found: kerf bench measures beside it")
    target_sources(${target} PRIVATE bench/peers/embree.cpp)
    set_source_files_properties(bench/peers/embree.cpp PROPERTIES
                                COMPILE_DEFINITIONS KERF_EMBREE_MAJOR=${EMBREE_VERSION_MAJOR})
    target_link_libraries(${target} PRIVATE embree)
  else()
    message(STATUS "Embree was not found: kerf bench stands alone")
    target_sources(${target} PRIVATE bench/peers/embree_absent.cpp)
  endif()
endfunction()
