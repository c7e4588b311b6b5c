# Manual pages and completions. The pages are made from --help by help2man, where that is installed;
# the completions read --help when they are used.

find_program(ESES_HELP2MAN help2man)
if(ESES_HELP2MAN AND NOT ESES_SANITIZE AND NOT CMAKE_CROSSCOMPILING)
  set(pages)
  foreach(page IN ITEMS
      "eses-blocks|eses-blocks|solvent excluded surface of a molecule on a grid"
      "eses-blocks-diff|eses-blocks diff|compares two directories of ESES's files")
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
