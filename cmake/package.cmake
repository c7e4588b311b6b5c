# `cpack` makes Debian packages of what is installed, see scripts/dev/package: `eses-blocks`, the
# program, and `libeses-dev`, the library with its headers and CMake package.

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME eses-blocks)
set(CPACK_PACKAGE_VENDOR "eses-blocks")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each has its own
set(CPACK_PACKAGE_CONTACT "The eses-blocks authors <eses-blocks@example.org>")
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL program development)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
# As Ubuntu's 0ubuntu1: of nothing that is in Debian, whose own would be -1.
set(CPACK_DEBIAN_PACKAGE_RELEASE 0eses1)
# Manual pages, changelogs and licences where Debian wants them.
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/packaging/debian.cmake)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME eses-blocks)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "apbs, pdb2pqr, paraview")
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION
"analytical solvent excluded surface on a Cartesian grid
Computes which points of a grid lie inside the solvent excluded surface
of a biomolecule, where the grid lines cross it, with normals and
adjacent atoms, and each atom's share of its area: the files of ESES,
exact on every input, block by block, in parallel and in bounded memory.")

# What eses-config.cmake looks for; OpenMP comes with the compiler.
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libeses-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS zlib1g-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_RECOMMENDS "cmake, g++ (>= 4:12)")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS eses-blocks)
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION
"solvent excluded surface on a grid: library and headers
The library of eses-blocks, with its C++20 headers and a CMake package.
It hands out the analytical solvent excluded surface of a molecule block
by block of a grid: inside points, crossings of grid lines with normals
and adjacent atoms, areas.")
include(CPack)
