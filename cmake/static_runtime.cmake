# Links as much of the compiler's runtime statically as this machine permits.
include(CheckCXXSourceCompiles)
include(CMakePushCheckState)

set(eses_static_options -static-libstdc++ -static-libgcc)
cmake_push_check_state(RESET)
set(CMAKE_REQUIRED_LINK_OPTIONS ${eses_static_options})
check_cxx_source_compiles("#include <iostream>\nint main() { std::cout << 1; }" ESES_HAS_STATIC_RUNTIME)
cmake_pop_check_state()

# clang++ accepts these options, but then links its own OpenMP runtime in addition. Only g++ gains
# from them.
function(target_link_static_runtime target)
  if(ESES_HAS_STATIC_RUNTIME AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_link_options(${target} PRIVATE ${eses_static_options})
  endif()
endfunction()

# Links the OpenMP runtime and zlib statically, where their archives are. The program then needs no
# library that a wheel would have to bring. All of an archive comes first, so that nothing needs the
# shared library.
function(target_link_static_libraries target)
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} -print-file-name=libgomp.a
                  OUTPUT_VARIABLE gomp OUTPUT_STRIP_TRAILING_WHITESPACE)
  find_library(ESES_STATIC_ZLIB NAMES libz.a)
  foreach(archive IN LISTS gomp ESES_STATIC_ZLIB)
    if(IS_ABSOLUTE "${archive}")
      target_link_options(${target} PRIVATE LINKER:--whole-archive,${archive},--no-whole-archive)
    endif()
  endforeach()
  target_link_libraries(${target} PRIVATE ${CMAKE_DL_LIBS})
endfunction()
