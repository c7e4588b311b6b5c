# cpack runs this script before it makes Debian packages of the installed files. It compresses
# manual pages and the changelog, names Debian's Python in the scripts, and adds the files on licences and changes that Debian requires.

set(project ${CMAKE_CURRENT_LIST_DIR}/..)
# Packages whose headers are compiled into the program and the library.
set(used_packages libcli11-dev libfmt-dev libhwy-dev libnanoflann-dev nlohmann-json3-dev)
# gemmi is optional, and the name of its package depends on the release.
foreach(package gemmi-dev libgemmi-dev tao-pegtl-dev)
  if(EXISTS /usr/share/doc/${package}/copyright)
    list(APPEND used_packages ${package})
  endif()
endforeach()
if(CPACK_COMPONENTS_ALL MATCHES "python")
  list(APPEND used_packages pybind11-dev)
endif()

function(compress file)
  execute_process(COMMAND gzip --best --no-name ${file} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

# The date of the release as `dpkg-parsechangelog` reads it.
file(STRINGS ${project}/CHANGELOG.md releases REGEX "^## \\[[0-9]")
list(GET releases 0 release)
if(NOT release MATCHES "^## \\[([0-9.]+)\\] - ([0-9-]+)$" OR NOT CMAKE_MATCH_1 STREQUAL CPACK_PACKAGE_VERSION)
  message(FATAL_ERROR "CHANGELOG.md: \"${release}\" should be of version ${CPACK_PACKAGE_VERSION}, with a date")
endif()
execute_process(COMMAND date --utc --rfc-email --date ${CMAKE_MATCH_2}
  OUTPUT_VARIABLE date OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)

# Converts LICENSE into Debian's format. Its first line is the name of the licence, its third line
# the copyright.
file(READ ${project}/LICENSE license)
string(REGEX REPLACE "^[^\n]*\n\n([^\n]*)\n\n(.*)\n$" "\\2" terms "${license}")
string(REGEX REPLACE "^Copyright \\(c\\) " "" holders "${CMAKE_MATCH_1}")
string(REPLACE "\n\n" "\n.\n" terms "${terms}")
string(REPLACE "\n" "\n " terms "${terms}")
list(JOIN used_packages ".copyright, " used_files)
set(copyright
"Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: eses-blocks
Comment: Headers of other packages are compiled in, under the terms that are
 beside this file: ${used_files}.copyright.

Files: *
Copyright: ${holders}
License: BSD-3-Clause
 ${terms}
")

function(finish_component root package)
  set(doc ${root}${CPACK_PACKAGING_INSTALL_PREFIX}/share/doc/${package})
  file(REMOVE ${doc}/LICENSE ${doc}/CHANGELOG.md)
  file(WRITE ${doc}/copyright "${copyright}")
  foreach(used IN LISTS used_packages)
    configure_file(/usr/share/doc/${used}/copyright ${doc}/${used}.copyright COPYONLY)
  endforeach()
  configure_file(${project}/CHANGELOG.md ${doc}/changelog COPYONLY)
  file(WRITE ${doc}/changelog.Debian
"eses-blocks (${CPACK_PACKAGE_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) unstable; urgency=medium

  * Release ${CPACK_PACKAGE_VERSION}. The changes are in changelog.gz.

 -- ${CPACK_PACKAGE_CONTACT}  ${date}
")
  file(GLOB pages ${root}${CPACK_PACKAGING_INSTALL_PREFIX}/share/man/man1/*.1)
  # Debian's scripts name its interpreter.
  file(GLOB scripts ${root}${CPACK_PACKAGING_INSTALL_PREFIX}/share/eses-blocks/*)
  foreach(script IN LISTS scripts)
    if(NOT IS_DIRECTORY ${script})
      execute_process(COMMAND sed -i "1s|^#!/usr/bin/env python3$|#!/usr/bin/python3|" ${script}
                      COMMAND_ERROR_IS_FATAL ANY)
    endif()
  endforeach()
  foreach(file IN LISTS pages ITEMS ${doc}/changelog ${doc}/changelog.Debian)
    compress(${file})
  endforeach()
endfunction()

foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER ${component} upper)
  finish_component(${CPACK_TEMPORARY_DIRECTORY}/${component}
    ${CPACK_DEBIAN_${upper}_PACKAGE_NAME})
endforeach()
