# Looks for gemmi, which reads PDB and mmCIF files. Version 0.5 has only headers; later versions have
# a library. Its CMake package is not used, because Debian's fails without the program gemmi.
# Sets eses_has_gemmi, and eses_gemmi_library if there is one.
set(ESES_WITH_GEMMI AUTO CACHE STRING "Read PDB and mmCIF files with gemmi: ON, OFF, or AUTO (if it is found)")
set(eses_has_gemmi FALSE)
set(eses_gemmi_library "")
if(NOT ESES_WITH_GEMMI)
  return()
endif()

find_path(GEMMI_INCLUDE_DIR gemmi/mmcif.hpp)
# gemmi's sources contain PEGTL.
find_path(PEGTL_INCLUDE_DIR tao/pegtl.hpp HINTS ${GEMMI_INCLUDE_DIR}/gemmi/third_party)
if(GEMMI_INCLUDE_DIR AND PEGTL_INCLUDE_DIR)
  file(STRINGS ${GEMMI_INCLUDE_DIR}/gemmi/version.hpp gemmi_version REGEX "define GEMMI_VERSION ")
  string(REGEX REPLACE ".*\"([0-9.]+).*" "\\1" gemmi_version "${gemmi_version}")
  if(gemmi_version VERSION_GREATER_EQUAL 0.6)
    find_library(GEMMI_LIBRARY gemmi_cpp HINTS ${GEMMI_INCLUDE_DIR}/../lib)
    if(GEMMI_LIBRARY)
      set(eses_has_gemmi TRUE)
      set(eses_gemmi_library ${GEMMI_LIBRARY})
    endif()
  elseif(gemmi_version VERSION_GREATER_EQUAL 0.5.7)
    set(eses_has_gemmi TRUE)
  endif()
endif()

if(NOT eses_has_gemmi AND ESES_WITH_GEMMI STREQUAL "AUTO")
  message(NOTICE "gemmi (0.5.7 or later) is missing, so this build reads xyzr and PQR files, but not PDB and mmCIF. In Debian and\n"
                 "Ubuntu the packages are gemmi-dev and tao-pegtl-dev, or libgemmi-dev in later releases.")
elseif(NOT eses_has_gemmi)
  list(APPEND eses_missing_packages gemmi-dev tao-pegtl-dev)
endif()
