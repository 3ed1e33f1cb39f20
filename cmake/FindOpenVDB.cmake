# Finds OpenVDB and defines OpenVDB::openvdb.
#
# The module that OpenVDB installs is not used: it switches BUILD_SHARED_LIBS on for the whole project and insists
# on development packages (Boost.Iostreams) that a user of the shared library does not need. This one asks for what
# is linked: the library, TBB and, for the half type in its headers, Imath (whose own package Debian ships with
# references to files of another package).
include(CMakeFindDependencyMacro)
find_dependency(TBB CONFIG)

find_path(OpenVDB_INCLUDE_DIR openvdb/version.h)
find_library(OpenVDB_LIBRARY openvdb)
find_library(OpenVDB_Imath_LIBRARY NAMES Imath Imath-3_1)
if(OpenVDB_INCLUDE_DIR)
  file(STRINGS ${OpenVDB_INCLUDE_DIR}/openvdb/version.h OpenVDB_VERSION
       REGEX "^#define OPENVDB_LIBRARY_VERSION_STRING \"")
  string(REGEX REPLACE ".*\"([0-9.]+)\".*" "\\1" OpenVDB_VERSION "${OpenVDB_VERSION}")
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenVDB REQUIRED_VARS OpenVDB_LIBRARY OpenVDB_INCLUDE_DIR
                                  OpenVDB_Imath_LIBRARY VERSION_VAR OpenVDB_VERSION)
mark_as_advanced(OpenVDB_INCLUDE_DIR OpenVDB_LIBRARY OpenVDB_Imath_LIBRARY)

if(OpenVDB_FOUND AND NOT TARGET OpenVDB::openvdb)
  add_library(OpenVDB::openvdb UNKNOWN IMPORTED)
  set_target_properties(OpenVDB::openvdb PROPERTIES IMPORTED_LOCATION ${OpenVDB_LIBRARY}
                                                    INTERFACE_INCLUDE_DIRECTORIES ${OpenVDB_INCLUDE_DIR}
                                                    INTERFACE_LINK_LIBRARIES "TBB::tbb;${OpenVDB_Imath_LIBRARY}")
endif()
