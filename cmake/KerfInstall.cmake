# `cmake --install` lays down the library and its headers so that `find_package(kerf)` finds them, and the tool.
# Components: `library`, what programs need that run; `development`, what is needed to compile some; `tool`.
include(CMakePackageConfigHelpers)

# kerf_install_library(TARGET RUNTIME DEVELOPMENT): into these components.
function(kerf_install_library target runtime development)
  install(
    TARGETS ${target}
    EXPORT kerfTargets
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${development}
    RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT ${runtime}
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${runtime} NAMELINK_COMPONENT ${development})
endfunction()

set(KERF_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/kerf)
kerf_install_library(kerf library development)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/kerf DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
install(EXPORT kerfTargets NAMESPACE kerf:: DESTINATION ${KERF_PACKAGE_DIR} COMPONENT development)

get_target_property(KERF_LIBRARY_TYPE kerf TYPE)
# Not beside bin/, where find_package would take it for an installed one as soon as bin/ is in PATH.
set(KERF_PACKAGE_FILES ${PROJECT_BINARY_DIR}/to_install)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/kerfConfig.cmake.in ${KERF_PACKAGE_FILES}/kerfConfig.cmake
                              INSTALL_DESTINATION ${KERF_PACKAGE_DIR})
# Before 1.0 a minor version may change the interface.
write_basic_package_version_file(${KERF_PACKAGE_FILES}/kerfConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${KERF_PACKAGE_FILES}/kerfConfig.cmake ${KERF_PACKAGE_FILES}/kerfConfigVersion.cmake
        DESTINATION ${KERF_PACKAGE_DIR} COMPONENT development)

# For users of pkg-config. A static library leaves the linking of what it stands on to the program that uses it.
function(kerf_install_pkg_config name language type)
  file(RELATIVE_PATH KERF_PC_PREFIX /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
  set(KERF_PC_REQUIRES Requires.private)
  if(type STREQUAL "STATIC_LIBRARY")
    set(KERF_PC_REQUIRES Requires)
  endif()
  set(KERF_PC_PACKAGES libhwy)
  if(KERF_THREADS STREQUAL "tbb")
    string(PREPEND KERF_PC_PACKAGES "tbb ")
  endif()
  configure_file(${PROJECT_SOURCE_DIR}/cmake/package.pc.in ${PROJECT_BINARY_DIR}/${name}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
endfunction()
kerf_install_pkg_config(kerf C++ ${KERF_LIBRARY_TYPE})
