# Looks for required packages and names the Debian packages of all that are missing in one message.

# Looks for a package. If it is missing, remembers the Debian package that contains it. Further
# arguments are those of find_package.
macro(eses_find_package name debian_package)
  find_package(${name} QUIET ${ARGN})
  if(NOT ${name}_FOUND)
    list(APPEND eses_missing_packages ${debian_package})
  endif()
endmacro()

# Looks for the directory of a header in the same way.
macro(eses_find_header variable header debian_package)
  find_path(${variable} ${header})
  if(NOT ${variable})
    list(APPEND eses_missing_packages ${debian_package})
  endif()
endmacro()

# Ends the configuration if a package is missing.
function(eses_require_packages)
  if(eses_missing_packages)
    list(JOIN eses_missing_packages " " packages)
    message(FATAL_ERROR "Required packages are missing. In Debian and Ubuntu, install them with\n"
                        "  apt-get install ${packages}")
  endif()
endfunction()
