# Links as much of the runtime of g++ statically as this machine permits. clang++ accepts the options
# of the standard library, but then links its own OpenMP runtime in addition, and gains nothing.
include(CheckCXXSourceCompiles)
include(CMakePushCheckState)

# Sets `variable` to the options that link all of an archive. The archive comes first, so that nothing
# needs the shared library.
function(link_options_of_archive variable archive)
  set(${variable} LINKER:--whole-archive,${archive},--no-whole-archive PARENT_SCOPE)
endfunction()

if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  set(eses_static_library_options -static-libstdc++ -static-libgcc)
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} -print-file-name=libgomp.a
                  OUTPUT_VARIABLE gomp OUTPUT_STRIP_TRAILING_WHITESPACE)
  link_options_of_archive(eses_static_openmp_options "${gomp}")
  cmake_push_check_state(RESET)
  set(CMAKE_REQUIRED_LINK_OPTIONS ${eses_static_library_options})
  check_cxx_source_compiles("#include <iostream>\nint main() { std::cout << 1; }" ESES_HAS_STATIC_RUNTIME)
  set(CMAKE_REQUIRED_FLAGS ${OpenMP_CXX_FLAGS})
  set(CMAKE_REQUIRED_LINK_OPTIONS ${eses_static_openmp_options})
  set(CMAKE_REQUIRED_LIBRARIES ${CMAKE_DL_LIBS})
  check_cxx_source_compiles("#include <omp.h>\nint main() { return omp_get_max_threads(); }"
                            ESES_HAS_STATIC_OPENMP)
  cmake_pop_check_state()
endif()

# src/main.cpp says why OpenMP is linked statically, too.
function(target_link_static_runtime target)
  if(ESES_HAS_STATIC_RUNTIME)
    target_link_options(${target} PRIVATE ${eses_static_library_options})
  endif()
  if(ESES_HAS_STATIC_OPENMP)
    target_link_options(${target} PRIVATE ${eses_static_openmp_options})
    target_link_libraries(${target} PRIVATE ${CMAKE_DL_LIBS})
  endif()
endfunction()

function(target_link_static_zlib target)
  find_library(ESES_STATIC_ZLIB NAMES libz.a)
  if(ESES_STATIC_ZLIB)
    link_options_of_archive(options ${ESES_STATIC_ZLIB})
    target_link_options(${target} PRIVATE ${options})
  endif()
endfunction()
