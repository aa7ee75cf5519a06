# The sources are the checkout that this port lies in. A port that names an archive has these lines in their place:
#
#   vcpkg_from_github(OUT_SOURCE_PATH SOURCE_PATH REPO ... REF "v${VERSION}" SHA512 ...)
get_filename_component(SOURCE_PATH "${CURRENT_PORT_DIR}/../../.." ABSOLUTE)

vcpkg_check_features(OUT_FEATURE_OPTIONS options FEATURES c KERF_BINDINGS_C)
set(threads std)
if("tbb" IN_LIST FEATURES)
  set(threads tbb)
endif()

vcpkg_cmake_configure(
  SOURCE_PATH "${SOURCE_PATH}"
  OPTIONS ${options} -DKERF_THREADS=${threads} -DKERF_BUILD_TOOL=OFF -DKERF_BUILD_TESTS=OFF -DKERF_BUILD_BENCHMARKS=OFF
          -DKERF_BUILD_EXAMPLES=OFF -DKERF_TEST_PACKAGE=OFF)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(CONFIG_PATH lib/cmake/kerf)
vcpkg_fixup_pkgconfig()
file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/debug/include")
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE")
file(INSTALL "${CURRENT_PORT_DIR}/usage" DESTINATION "${CURRENT_PACKAGES_DIR}/share/${PORT}")
