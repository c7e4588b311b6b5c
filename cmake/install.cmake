# Installs the program, the library with its headers, and the CMake package `eses`:
#
#   find_package(eses REQUIRED)
#   target_link_libraries(mine PRIVATE eses::eses)
#
# Other build systems find the library by eses.pc.
#
# The components are those of the Debian packages (package.cmake): `program`, and `development` for
# users of the library.

include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(ESES_INSTALL_CMAKEDIR ${CMAKE_INSTALL_LIBDIR}/cmake/eses)

# A shared library (BUILD_SHARED_LIBS) changes its soname with every version that may break callers.
set_target_properties(eses PROPERTIES
  VERSION ${PROJECT_VERSION}
  SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})

install(TARGETS eses EXPORT eses-targets
        LIBRARY COMPONENT development ARCHIVE COMPONENT development)
if(ESES_BUILD_PROGRAM)
  install(TARGETS eses-blocks COMPONENT program)
  # The program finds by these names that it replaces MSMS and its scripts.
  foreach(name msms pdb_to_xyzr pdb_to_xyzrn)
    set(link ${PROJECT_BINARY_DIR}/eses-${name})
    file(CREATE_LINK eses-blocks ${link} SYMBOLIC)
    install(FILES ${link} DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
  endforeach()
endif()

# Removes what the last installation has written.
add_custom_target(uninstall
  COMMAND ${CMAKE_COMMAND} -DBUILD=${PROJECT_BINARY_DIR} -P ${PROJECT_SOURCE_DIR}/cmake/uninstall.cmake VERBATIM)

# The scripts for users are installed in ESES_SCRIPT_DIR, where they find the package eses_tools. Links
# in the folder of the program have the prefix eses-. eses_tools/common.py knows this layout.
set(ESES_TOOLS_FILES FILES_MATCHING PATTERN "*.py" PATTERN "*.html" PATTERN "*.js" PATTERN "*.css"
    PATTERN __pycache__ EXCLUDE)
set(ESES_SCRIPTS apbs assemble pdbbind render report traj view)
set(ESES_SCRIPT_DIR ${CMAKE_INSTALL_DATADIR}/eses-blocks)
file(RELATIVE_PATH to_scripts ${CMAKE_INSTALL_FULL_BINDIR}
     ${CMAKE_INSTALL_FULL_DATADIR}/eses-blocks)
foreach(script IN LISTS ESES_SCRIPTS)
  set(link ${PROJECT_BINARY_DIR}/links/eses-${script})
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/links)
  file(CREATE_LINK ${to_scripts}/${script} ${link} SYMBOLIC)
  install(PROGRAMS scripts/${script} DESTINATION ${ESES_SCRIPT_DIR} COMPONENT program)
  install(FILES ${link} DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
endforeach()
install(DIRECTORY scripts/eses_tools DESTINATION ${ESES_SCRIPT_DIR} COMPONENT program ${ESES_TOOLS_FILES})

install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
        COMPONENT development FILES_MATCHING PATTERN "*.hpp")
install(FILES ${PROJECT_BINARY_DIR}/generated/eses/version.hpp
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/eses COMPONENT development)
install(FILES README.md LICENSE CHANGELOG.md CITATION.cff CONTRIBUTING.md SECURITY.md
        DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
install(FILES scripts/eses_pymol.py
        DESTINATION ${CMAKE_INSTALL_DATADIR}/eses-blocks COMPONENT program)
# Install the pages and their figures, but not the measurements from which the figures are made.
install(DIRECTORY doc DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program
        FILES_MATCHING PATTERN "*.md" PATTERN "*.svg" PATTERN "*.png" PATTERN "*.sbatch")

install(EXPORT eses-targets NAMESPACE eses:: DESTINATION ${ESES_INSTALL_CMAKEDIR}
        COMPONENT development)
get_target_property(ESES_LIBRARY_TYPE eses TYPE)
configure_package_config_file(
  ${CMAKE_CURRENT_LIST_DIR}/eses-config.cmake.in ${PROJECT_BINARY_DIR}/eses-config.cmake
  INSTALL_DESTINATION ${ESES_INSTALL_CMAKEDIR}
  NO_SET_AND_CHECK_MACRO)
# Before 1.0 a minor version may be incompatible with the previous one.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/eses-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/eses-config.cmake
              ${PROJECT_BINARY_DIR}/eses-config-version.cmake
        DESTINATION ${ESES_INSTALL_CMAKEDIR} COMPONENT development)

# For build systems other than CMake: `pkg-config --cflags --libs --static eses`. All paths are
# relative to the file, so that the installation can be moved.
set(pkgconfig_directory ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig)
file(RELATIVE_PATH ESES_PC_PREFIX ${pkgconfig_directory} ${CMAKE_INSTALL_PREFIX})
string(REGEX REPLACE "/$" "" ESES_PC_PREFIX "${ESES_PC_PREFIX}")
file(RELATIVE_PATH ESES_PC_LIBDIR ${CMAKE_INSTALL_PREFIX} ${CMAKE_INSTALL_FULL_LIBDIR})
file(RELATIVE_PATH ESES_PC_INCLUDEDIR ${CMAKE_INSTALL_PREFIX} ${CMAKE_INSTALL_FULL_INCLUDEDIR})
string(STRIP "${eses_gemmi_library} ${OpenMP_CXX_FLAGS} ${CMAKE_THREAD_LIBS_INIT}" ESES_PC_LIBRARIES)
configure_file(packaging/eses.pc.in ${PROJECT_BINARY_DIR}/eses.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/eses.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig
        COMPONENT development)
