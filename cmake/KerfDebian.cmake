# Debian packages by CPack, one for each component: scripts/deb sets the build up and makes them. What policy asks of
# each beside its files (copyright, changelog, the trigger of ldconfig) is made here or by CPack.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME kerf)
set(CPACK_PACKAGE_VENDOR "the kerf maintainers")
set(CPACK_PACKAGE_CONTACT "The kerf maintainers <maintainers@users.noreply.example>")
set(CPACK_COMPONENTS_ALL library development tool)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 0.1)  # not one of Debian's own
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR}/lib)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

set(soversion ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libkerf${soversion})
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/debian/triggers)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each has its own: the first line
set(CPACK_COMPONENT_LIBRARY_DESCRIPTION
    "split bounding volume hierarchies over triangle meshes
Exact, watertight and deterministic tracing of rays through triangle
meshes, and spatial queries on them: inside or outside, closest point,
signed distance, mesh against mesh.
.
This package has the shared libraries, for programs in C++ and in C.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libkerf-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
    "libkerf${soversion} (= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}), libhwy-dev, libtbb-dev")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION
    "headers of kerf, a library of split bounding volume hierarchies
Exact, watertight and deterministic tracing of rays through triangle
meshes, and spatial queries on them.
.
This package has what is needed to compile programs in C++20, C++11 and
C99: the headers, the CMake package, and files for pkg-config.")
set(CPACK_DEBIAN_TOOL_PACKAGE_NAME kerf)
set(CPACK_DEBIAN_TOOL_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_TOOL_PACKAGE_DEPENDS
    "libkerf${soversion} (= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})")
set(CPACK_COMPONENT_TOOL_DESCRIPTION
    "builds, compares and saves hierarchies of triangle meshes
Builds split bounding volume hierarchies of scenes (OBJ, PLY, STL, glTF),
draws pictures of them, compares the ways of building them, and saves
them for programs that use the library.")

file(WRITE ${PROJECT_BINARY_DIR}/debian/triggers "activate-noawait ldconfig\n")
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/KerfDebianFiles.cmake)
include(CPack)
