# `cpack` makes Debian packages of the installed files (scripts/dev/package): `eses-blocks` with the
# program, `libeses-dev` with the library, its headers and CMake package, and, with
# ESES_BUILD_PYTHON, `python3-eses-blocks`.

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME eses-blocks)
set(CPACK_PACKAGE_VENDOR "eses-blocks")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each package has its own
set(CPACK_PACKAGE_CONTACT "" CACHE STRING "Maintainer of the Debian packages, as NAME <ADDRESS>")
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL program development)
if(ESES_BUILD_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
# Debian's own package would have revision -1. Revision 0eses1 sorts before it, like Ubuntu's
# 0ubuntu1.
set(CPACK_DEBIAN_PACKAGE_RELEASE 0eses1)
# Put manual pages, changelogs and licences where Debian expects them.
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/packaging/debian.cmake)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME eses-blocks)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
# The scripts need nothing but Python, and say which program they miss.
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "python3:any")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "apbs, pdb2pqr, paraview, python3-numpy, python3-vtk9, python3-eses-blocks, python3-mdanalysis, xvfb")
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION
"analytical solvent excluded surface on a Cartesian grid
Computes which points of a grid lie inside the solvent excluded surface
of a biomolecule, where the grid lines cross it, with normals and
adjacent atoms, and each atom's share of its area: the files of ESES,
exact on every input, block by block, in parallel and in bounded memory.
Scripts compute energies with APBS (eses-apbs) and folders of structures
(eses-pdbbind), build large complexes (eses-assemble), render meshes
(eses-render) and measure trajectories (eses-traj) and write pages that
show surfaces (eses-view) or the results of many structures
(eses-report) in a browser.")

# These are the packages that eses-config.cmake looks for. OpenMP comes with the compiler.
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libeses-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS zlib1g-dev)
if(eses_gemmi_library)  # a library of its own since version 0.6
  string(APPEND CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS ", libgemmi-dev | gemmi-dev")
endif()
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_RECOMMENDS "cmake, g++ (>= 4:12)")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS eses-blocks)
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION
"solvent excluded surface on a grid: library and headers
The library of eses-blocks, with its C++20 headers and a CMake package.
It hands out the analytical solvent excluded surface of a molecule block
by block of a grid: inside points, crossings of grid lines with normals
and adjacent atoms, areas.")

# The file name of the module contains the version of Python for which it is built.
if(ESES_BUILD_PYTHON)
  string(REPLACE "." ";" python_version ${ESES_PYTHON_VERSION})
  list(GET python_version 0 python_major)
  list(GET python_version 1 python_minor)
  math(EXPR next_python_minor "${python_minor} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-eses-blocks)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
      "python3 (>= ${ESES_PYTHON_VERSION}), python3 (<< ${python_major}.${next_python_minor}), python3-numpy")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "eses-blocks, python3-mdanalysis")
  set(CPACK_DEBIAN_PYTHON_DESCRIPTION
"solvent excluded surface on a grid: Python package
The library of eses-blocks as the Python package eses_blocks. It
computes the analytical solvent excluded surface of a molecule on a
Cartesian grid and returns numpy arrays: inside points, crossings of
grid lines with normals and adjacent atoms, areas of atoms, meshes.")
endif()
include(CPack)
