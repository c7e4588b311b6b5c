# Manual pages, completions, and the reference of the library. scripts/dev/make-manual makes the manual
# pages from --help-all. The completions read --help-all when they are used.

install(DIRECTORY packaging/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)
install(FILES packaging/completions/eses-blocks.bash
        DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT program
        RENAME eses-blocks)
install(FILES packaging/completions/_eses-blocks packaging/completions/_eses-tools
        DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT program)
install(FILES packaging/completions/eses-blocks.fish
        DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT program)
# bash and fish look for the completions of a command in a file of its name.
foreach(name apbs assemble msms pdb_to_xyzr pdb_to_xyzrn pdbbind render report traj view)
  install(FILES packaging/completions/eses-blocks.bash
          DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT program
          RENAME eses-${name})
  install(FILES packaging/completions/eses-blocks.fish
          DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT program
          RENAME eses-${name}.fish)
endforeach()

# The target `reference` makes HTML pages of the public headers. Every warning of Doxygen is an
# error, such as a name without a description.
find_package(Doxygen QUIET)
if(DOXYGEN_FOUND)
  set(DOXYGEN_PROJECT_NAME "eses-blocks")
  set(DOXYGEN_PROJECT_BRIEF "Analytical solvent excluded surface on a Cartesian grid")
  set(DOXYGEN_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/reference)
  set(DOXYGEN_STRIP_FROM_PATH ${PROJECT_SOURCE_DIR}/include ${PROJECT_BINARY_DIR}/generated)
  set(DOXYGEN_STRIP_FROM_INC_PATH ${DOXYGEN_STRIP_FROM_PATH})
  set(DOXYGEN_FILE_PATTERNS *.hpp)
  set(DOXYGEN_EXCLUDE_SYMBOLS eses::detail "eses::detail::*")
  set(DOXYGEN_EXTRACT_ALL NO)
  set(DOXYGEN_EXTRACT_LOCAL_CLASSES NO)
  set(DOXYGEN_WARN_IF_UNDOCUMENTED YES)
  set(DOXYGEN_WARN_NO_PARAMDOC NO)
  set(DOXYGEN_WARN_AS_ERROR FAIL_ON_WARNINGS)
  set(DOXYGEN_QUIET YES)
  set(DOXYGEN_JAVADOC_AUTOBRIEF YES)
  set(DOXYGEN_GENERATE_LATEX NO)
  set(DOXYGEN_HAVE_DOT NO)
  doxygen_add_docs(reference ${PROJECT_SOURCE_DIR}/include/eses
                   ${PROJECT_BINARY_DIR}/generated/eses
                   COMMENT "Reference of the library in ${PROJECT_BINARY_DIR}/reference/html")
endif()
