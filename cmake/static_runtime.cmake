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
