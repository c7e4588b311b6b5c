# Manual pages, completions, and the reference of the library. help2man makes the manual pages from
# --help if it is installed. The completions read --help when they are used.

find_program(ESES_HELP2MAN help2man)
if(ESES_HELP2MAN AND ESES_BUILD_PROGRAM AND NOT ESES_SANITIZE AND NOT CMAKE_CROSSCOMPILING)
  set(pages)
  foreach(page IN ITEMS
      "eses-blocks|eses-blocks|solvent excluded surface of a molecule on a grid"
      "eses-blocks-diff|eses-blocks diff|compares two directories of ESES's files"
      "eses-blocks-measure|eses-blocks measure|areas and volumes of molecular surfaces without a grid"
      "eses-msms|eses-blocks msms|molecular surfaces with the options and files of MSMS")
    string(REPLACE "|" ";" parts "${page}")
    list(GET parts 0 name)
    list(GET parts 1 command)
    list(GET parts 2 title)
    string(REPLACE "eses-blocks" "./eses-blocks" command "${command}")
    add_custom_command(
      OUTPUT ${PROJECT_BINARY_DIR}/${name}.1
      COMMAND ${ESES_HELP2MAN} --no-info --section 1 --name "${title}"
              --version-string "eses-blocks ${PROJECT_VERSION}"
              --include ${PROJECT_SOURCE_DIR}/packaging/eses-blocks.h2m
              --output ${PROJECT_BINARY_DIR}/${name}.1 ${command}
      DEPENDS eses-blocks ${PROJECT_SOURCE_DIR}/packaging/eses-blocks.h2m
      WORKING_DIRECTORY ${PROJECT_BINARY_DIR}
      VERBATIM)
    list(APPEND pages ${PROJECT_BINARY_DIR}/${name}.1)
  endforeach()
  # The scripts are called by their installed names, which their help shows.
  foreach(page IN ITEMS
      "apbs|electrostatic energies with APBS on maps of the molecular surface"
      "assemble|builds a large complex from copies of one structure"
      "pdbbind|molecular surfaces of all structures below a folder"
      "render|pictures of meshes of molecular surfaces"
      "report|pages with the results of many structures"
      "view|pages that show molecular surfaces in a browser")
    string(REPLACE "|" ";" parts "${page}")
    list(GET parts 0 script)
    list(GET parts 1 title)
    set(name ${PROJECT_BINARY_DIR}/manual/eses-${script})
    file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/manual)
    file(CREATE_LINK ${PROJECT_SOURCE_DIR}/scripts/${script} ${name} SYMBOLIC)
    add_custom_command(
      OUTPUT ${name}.1
      COMMAND ${ESES_HELP2MAN} --no-info --section 1 --name "${title}"
              --version-string "eses-${script} (eses-blocks) ${PROJECT_VERSION}"
              --include ${PROJECT_SOURCE_DIR}/packaging/scripts.h2m --output ${name}.1 ${name}
      DEPENDS ${PROJECT_SOURCE_DIR}/scripts/${script} ${PROJECT_SOURCE_DIR}/packaging/scripts.h2m
      VERBATIM)
    list(APPEND pages ${name}.1)
  endforeach()
  add_custom_target(manual ALL DEPENDS ${pages})
  install(FILES ${pages} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)
elseif(NOT ESES_HELP2MAN)
  message(NOTICE "help2man is not installed: manual pages are left out")
endif()

install(FILES packaging/completions/eses-blocks.bash
        DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT program
        RENAME eses-blocks)
install(FILES packaging/completions/_eses-blocks
        DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT program)

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
