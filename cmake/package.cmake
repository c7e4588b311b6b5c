# `cpack` makes a Debian package of what is installed, see scripts/package.

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME eses-blocks)
set(CPACK_PACKAGE_VENDOR "eses-blocks")
set(CPACK_PACKAGE_CONTACT "The developers of eses-blocks <eses-blocks@example.org>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "analytical solvent excluded surface on a Cartesian grid")
set(CPACK_PACKAGE_DESCRIPTION
"Computes which points of a grid lie inside the solvent excluded surface of a
biomolecule, where the grid lines cross it, with normals and adjacent atoms, and
each atom's share of its area: the files of ESES, exact on every input, block by
block, in parallel and in bounded memory.")
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "pdb2pqr, paraview")
include(CPack)
