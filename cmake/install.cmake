# What `cmake --install` lays down: headers as <prcage/...>, library, program, CMake package, pkg-config file.
include(CMakePackageConfigHelpers)
set(prcage_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/prcage)
set(prcage_generated_dir ${PROJECT_BINARY_DIR}/install)

# The public headers lie in two directories of the sources and in one when installed, so that the include of one in
# the other is rewritten.
foreach(header core/prcage.h io/mesh_file.h io/weights_file.h)
  get_filename_component(name ${header} NAME)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/${header})
  file(READ ${PROJECT_SOURCE_DIR}/src/${header} text)
  string(REPLACE "#include \"core/prcage.h\"" "#include <prcage/prcage.h>" text "${text}")
  string(REPLACE "#include \"io/mesh_file.h\"" "#include <prcage/mesh_file.h>" text "${text}")
  if(text MATCHES "#include \"")
    message(FATAL_ERROR "src/${header} is public but includes a header that is not installed")
  endif()
  file(CONFIGURE OUTPUT ${prcage_generated_dir}/${name} CONTENT "${text}" @ONLY)
  install(FILES ${prcage_generated_dir}/${name} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/prcage)
endforeach()

install(TARGETS prcage EXPORT prcageTargets)
if(TARGET prcage_cli)
  if(BUILD_SHARED_LIBS)
    set_target_properties(prcage_cli PROPERTIES INSTALL_RPATH $ORIGIN/../${CMAKE_INSTALL_LIBDIR})
  endif()
  install(TARGETS prcage_cli)
endif()

install(EXPORT prcageTargets NAMESPACE prcage:: DESTINATION ${prcage_package_dir})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/prcageConfig.cmake.in
                              ${prcage_generated_dir}/prcageConfig.cmake INSTALL_DESTINATION ${prcage_package_dir})
write_basic_package_version_file(${prcage_generated_dir}/prcageConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${prcage_generated_dir}/prcageConfig.cmake ${prcage_generated_dir}/prcageConfigVersion.cmake
        DESTINATION ${prcage_package_dir})

# Whoever links the archive links what it calls; `pkg-config --libs` says so without --static, as there is no shared
# library to choose instead.
if(NOT BUILD_SHARED_LIBS)
  install(FILES ${PROJECT_SOURCE_DIR}/cmake/FindOpenVDB.cmake DESTINATION ${prcage_package_dir})
  set(prcage_pc_dependencies " -lembree3 -lopenvdb -lImath -ltbb -lmpfr -lgmp")
endif()
set(prcage_pc_dir ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
file(RELATIVE_PATH prcage_pc_to_prefix /prefix/${prcage_pc_dir} /prefix)
string(REGEX REPLACE "/$" "" prcage_pc_to_prefix ${prcage_pc_to_prefix})
configure_file(${PROJECT_SOURCE_DIR}/cmake/prcage.pc.in ${prcage_generated_dir}/prcage.pc @ONLY)
install(FILES ${prcage_generated_dir}/prcage.pc DESTINATION ${prcage_pc_dir})

install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
