# Links as much of the compiler's runtime statically as this machine permits.
include(CheckCXXSourceCompiles)
include(CMakePushCheckState)

set(eses_static_options -static-libstdc++ -static-libgcc)
cmake_push_check_state(RESET)
set(CMAKE_REQUIRED_LINK_OPTIONS ${eses_static_options})
check_cxx_source_compiles("#include <iostream>\nint main() { std::cout << 1; }" ESES_HAS_STATIC_RUNTIME)
cmake_pop_check_state()

# Links these archives statically, where they are. All of an archive comes first, so that nothing needs
# the shared library.
function(target_link_archives target)
  foreach(archive IN LISTS ARGN)
    if(IS_ABSOLUTE "${archive}")
      target_link_options(${target} PRIVATE LINKER:--whole-archive,${archive},--no-whole-archive)
    endif()
  endforeach()
endfunction()

# clang++ accepts these options, but then links its own OpenMP runtime in addition. Only g++ gains
# from them. src/main.cpp says why OpenMP is linked statically, too.
function(target_link_static_runtime target)
  if(ESES_HAS_STATIC_RUNTIME AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    execute_process(COMMAND ${CMAKE_CXX_COMPILER} -print-file-name=libgomp.a
                    OUTPUT_VARIABLE gomp OUTPUT_STRIP_TRAILING_WHITESPACE)
    target_link_options(${target} PRIVATE ${eses_static_options})
    target_link_archives(${target} "${gomp}")
    target_link_libraries(${target} PRIVATE ${CMAKE_DL_LIBS})
  endif()
endfunction()
