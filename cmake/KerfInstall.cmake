# `cmake --install` lays down the library and its headers so that `find_package(kerf)` finds them, and the tool.
include(CMakePackageConfigHelpers)

set(KERF_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/kerf)
install(
  TARGETS kerf
  EXPORT kerfTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/kerf DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT library)
install(EXPORT kerfTargets NAMESPACE kerf:: DESTINATION ${KERF_PACKAGE_DIR} COMPONENT library)

get_target_property(KERF_LIBRARY_TYPE kerf TYPE)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/kerfConfig.cmake.in ${PROJECT_BINARY_DIR}/kerfConfig.cmake
                              INSTALL_DESTINATION ${KERF_PACKAGE_DIR})
# Before 1.0 a minor version may change the interface.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/kerfConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/kerfConfig.cmake ${PROJECT_BINARY_DIR}/kerfConfigVersion.cmake
        DESTINATION ${KERF_PACKAGE_DIR} COMPONENT library)
