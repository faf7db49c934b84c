# How Polhode's own code is compiled. One place for flags, so that a record can name them.

set_property(GLOBAL PROPERTY POLHODE_SOURCES ${PROJECT_SOURCE_DIR})
include(PolhodeUnits)
# -Wrestrict is wrong about concatenated strings in g++ 12 (GCC bug 105651).
set(POLHODE_WARNINGS -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wno-restrict $<$<BOOL:${POLHODE_WERROR}>:-Werror>)

find_program(CCACHE ccache)
if(CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # Paths count from the source folder, so that two clones of one version compile it once.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1
                                  ${CCACHE})
endif()

# The arithmetic, the warnings and the include root of everything we write.
function(polhode_compile_options target)
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
  get_property(arithmetic GLOBAL PROPERTY POLHODE_ARITHMETIC)
  target_compile_options(${target} PRIVATE ${POLHODE_WARNINGS} ${arithmetic})
  target_compile_features(${target} PUBLIC cxx_std_20)
endfunction()

# polhode_NAME is polhode::NAME where it is linked, here and in an installation.
function(polhode_export target)
  string(REPLACE "polhode_" "" name ${target})
  add_library(polhode::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
endfunction()

function(polhode_library target)
  add_library(${target} STATIC ${ARGN})
  polhode_export(${target})
  polhode_compile_options(${target})
endfunction()

function(polhode_executable target)
  add_executable(${target} ${ARGN})
  polhode_compile_options(${target})
endfunction()
