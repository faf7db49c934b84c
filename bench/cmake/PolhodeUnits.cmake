# Binaries that know Polhode's catalogues and what is added to them. For Polhode's own build and, installed, for others:
#
#   find_package(polhode 0.1 REQUIRED COMPONENTS harness)
#   polhode_add_binary(my_polhode INTEGRATORS heun.hpp:Heun PROBLEMS damped_body.hpp:my::DampedBody)
#   polhode_add_conformance(my_polhode)     # tests of what was added; needs GTest
#
# Whoever includes this file sets the global property POLHODE_SOURCES, the folder of bench/solve/*_unit.cpp and tests/, and may
# set POLHODE_WARNINGS, flags for what is compiled here.

# Speed without changing results: IEEE arithmetic in every build, so that counts and round-off agree between machines.
set_property(GLOBAL PROPERTY POLHODE_ARITHMETIC -ffp-contract=off -fno-math-errno)

# Compiles bench/solve/`source` once more, with definitions, for `target`, an INTERFACE library or an archive.
function(polhode_unit target name source)
  get_property(sources GLOBAL PROPERTY POLHODE_SOURCES)
  get_property(arithmetic GLOBAL PROPERTY POLHODE_ARITHMETIC)
  add_library(${name} OBJECT ${sources}/bench/solve/${source})
  target_link_libraries(${name} PRIVATE polhode::core)
  target_compile_definitions(${name} PRIVATE ${ARGN})
  # Stores of mixed width stall the reads of the next step: 4.2x -> 2.4x on an erased field.
  # The first error says in words what an entry lacks; the others are its echo.
  target_compile_options(${name} PRIVATE ${POLHODE_WARNINGS} ${arithmetic} $<$<CONFIG:Release>:-fno-tree-slp-vectorize>
                                         $<$<CXX_COMPILER_ID:GNU>:-fmax-errors=1>)
  get_target_property(kind ${target} TYPE)
  if(kind STREQUAL INTERFACE_LIBRARY)
    target_sources(${target} INTERFACE $<TARGET_OBJECTS:${name}>)
  else()
    target_sources(${target} PRIVATE $<TARGET_OBJECTS:${name}>)
  endif()
endfunction()

# One list of integrators on every kind of space: units NAME_KIND.
set_property(GLOBAL PROPERTY POLHODE_KINDS OneBody Attitudes Bodies Position)
function(polhode_integrator_units target name list header)
  get_property(kinds GLOBAL PROPERTY POLHODE_KINDS)
  foreach(kind IN LISTS kinds)
    polhode_unit(${target} ${name}_${kind} methods_unit.cpp POLHODE_METHODS=${list} POLHODE_SPACES=${kind}Spaces
                 "POLHODE_METHODS_HEADER=\"${header}\"")
    # Behind virtual calls -O3 gains nothing, for twice the compile time.
    target_compile_options(${name}_${kind} PRIVATE $<$<CONFIG:Release>:-O2>)
  endforeach()
endfunction()

# One problem, apart from its races; further arguments are definitions.
function(polhode_problem_unit target name type header)
  polhode_unit(${target} ${name} problem_unit.cpp POLHODE_PROBLEM=${type} "POLHODE_PROBLEM_HEADER=\"${header}\"" ${ARGN})
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O2>)
endfunction()

# One list of integrators raced on one problem, as typed code.
function(polhode_timed_unit target name type header list list_header)
  polhode_unit(${target} ${name} timed_unit.cpp POLHODE_PROBLEM=${type} "POLHODE_PROBLEM_HEADER=\"${header}\""
               POLHODE_METHODS=${list} "POLHODE_METHODS_HEADER=\"${list_header}\"")
endfunction()
# Scheduling before register allocation hides the latency of a step's long chain: RK4 0.9 of the time. It costs Odeint
# 10%, so the rivals' units, which get what serves them best, do without. (DP5 on the free body pays 1.2; on the slew it
# gains.)
function(polhode_schedule name)
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-fschedule-insns -fsched-pressure>)
endfunction()

# The header of a problem of Polhode: SomeProblem5 is in problems/some_problem5.hpp.
function(polhode_header_of type result)
  string(REGEX REPLACE "([a-z0-9])([A-Z])" "\\1_\\2" name ${type})
  string(TOLOWER ${name} name)
  set(${result} problems/${name}.hpp PARENT_SCOPE)
endfunction()

# Of an entry HEADER:TYPE the type, and the whole path of the header.
function(polhode_entry entry type_result header_result)
  if(NOT entry MATCHES "^([^:]+):([A-Za-z_].*)$")
    message(FATAL_ERROR "polhode_add_binary: ${entry}: give HEADER:TYPE, heun.hpp:my::Heun for instance")
  endif()
  set(type ${CMAKE_MATCH_2})
  cmake_path(ABSOLUTE_PATH CMAKE_MATCH_1 BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} NORMALIZE OUTPUT_VARIABLE header)
  if(NOT EXISTS ${header})
    message(FATAL_ERROR "polhode_add_binary: there is no ${header}")
  endif()
  set(${type_result} ${type} PARENT_SCOPE)
  set(${header_result} ${header} PARENT_SCOPE)
endfunction()
# Of many the types, separated by commas, and the lines that include the headers.
function(polhode_entries types_result includes_result)
  set(types "")
  set(includes "")
  foreach(entry IN LISTS ARGN)
    polhode_entry(${entry} type header)
    list(APPEND types ${type})
    string(APPEND includes "#include \"${header}\"\n")
  endforeach()
  list(JOIN types ", " types)
  set(${types_result} "${types}" PARENT_SCOPE)
  set(${includes_result} "${includes}" PARENT_SCOPE)
endfunction()

# polhode_add_binary(NAME [INTEGRATORS HEADER:TYPE...] [PROBLEMS HEADER:TYPE...] [RACES TYPE...])
# An executable with the verbs of polhode, which knows what Polhode knows and these. Headers are looked for from the
# current source folder; types may be in any namespace. RACES names problems of Polhode (FreeBody, PdSlew, ...) on which
# the added integrators are timed, as typed code like the others; on added problems all are, through virtual calls.
# NAME_catalog is what it knows, for executables with a main() of their own.
function(polhode_add_binary name)
  cmake_parse_arguments(PARSE_ARGV 1 added "" "" "INTEGRATORS;PROBLEMS;RACES")
  if(added_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "polhode_add_binary: unknown ${added_UNPARSED_ARGUMENTS}; it takes INTEGRATORS, PROBLEMS, RACES")
  endif()
  if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
    message(STATUS "polhode_add_binary: no CMAKE_BUILD_TYPE is set; building Release")
    set(CMAKE_BUILD_TYPE Release PARENT_SCOPE)
  endif()
  if(CMAKE_CXX_FLAGS MATCHES "-m(arch|cpu|avx)" AND NOT TARGET polhode_units)
    message(WARNING "polhode_add_binary: ${CMAKE_MATCH_0} in CMAKE_CXX_FLAGS changes how wide vectors are, and so types that "
                    "the installed archives share with ${name}: build Polhode itself with the same flag")
  endif()
  get_property(data GLOBAL PROPERTY POLHODE_DATA)
  string(MAKE_C_IDENTIFIER ${name}_integrators list)
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/${name}_catalog)
  set(head "#pragma once\n// Written by polhode_add_binary(${name}).\n")
  polhode_entries(integrators integrator_headers ${added_INTEGRATORS})
  polhode_entries(problems problem_headers ${added_PROBLEMS})
  list(JOIN added_RACES ", " races)
  set(lists "")
  set(declaration "")
  if(added_INTEGRATORS)
    set(lists ${list})
    file(CONFIGURE OUTPUT ${folder}/integrators.hpp @ONLY CONTENT "${head}#include \"problems/formulations.hpp\"
${integrator_headers}
namespace polhode {

struct ${list} : Types<${integrators}> {};

}  // namespace polhode
")
    set(declaration "struct ${list};\n")
  endif()
  file(CONFIGURE OUTPUT ${folder}/additions.hpp @ONLY CONTENT "${head}#include \"problems/catalog.hpp\"
${problem_headers}
namespace polhode {

${declaration}using AddedLists = Types<${lists}>;
using AddedProblems = Types<${problems}>;
using AddedRaces = Types<${races}>;
inline constexpr char const* added_data = \"${data}\";

}  // namespace polhode
")

  add_library(${name}_catalog INTERFACE)
  polhode_unit(${name}_catalog ${name}_catalogue catalogue_unit.cpp "POLHODE_ADDITIONS=\"${folder}/additions.hpp\"")
  target_compile_options(${name}_catalogue PRIVATE $<$<CONFIG:Release>:-O1>)
  target_link_libraries(${name}_catalogue PRIVATE polhode::units)
  target_link_libraries(${name}_catalog INTERFACE polhode::units)
  if(added_INTEGRATORS)
    polhode_integrator_units(${name}_catalog ${name}_integrators ${list} ${folder}/integrators.hpp)
    foreach(type IN LISTS added_RACES)
      polhode_header_of(${type} header)
      polhode_timed_unit(${name}_catalog ${name}_${type}_timed ${type} ${header} ${list} ${folder}/integrators.hpp)
      polhode_schedule(${name}_${type}_timed)
    endforeach()
  endif()
  foreach(entry IN LISTS added_PROBLEMS)
    polhode_entry(${entry} type header)
    string(MAKE_C_IDENTIFIER ${type} unit)
    polhode_problem_unit(${name}_catalog ${name}_${unit} ${type} ${header})
  endforeach()

  add_executable(${name})
  target_link_libraries(${name} PRIVATE ${name}_catalog polhode::main)
  set_target_properties(${name} PROPERTIES LINKER_LANGUAGE CXX)
  set_target_properties(${name}_catalog PROPERTIES
    POLHODE_LIST "${lists}" POLHODE_LIST_HEADER ${folder}/integrators.hpp POLHODE_PROBLEMS "${added_PROBLEMS}")
endfunction()

# polhode_add_conformance(NAME)
# Tests of what the binary NAME adds, by the checks that Polhode's own catalogues pass: orders, symmetry, claimed
# invariants, who runs and who is refused, timed runs, certified references, laws of spaces. CTest's names begin with
# NAME; its executable is NAME_conformance. Some take minutes.
function(polhode_add_conformance name)
  find_package(GTest 1.12 REQUIRED)
  include(GoogleTest)
  get_property(sources GLOBAL PROPERTY POLHODE_SOURCES)
  get_property(arithmetic GLOBAL PROPERTY POLHODE_ARITHMETIC)
  get_target_property(list ${name}_catalog POLHODE_LIST)
  get_target_property(list_header ${name}_catalog POLHODE_LIST_HEADER)
  get_target_property(problems ${name}_catalog POLHODE_PROBLEMS)
  set(target ${name}_conformance)
  add_executable(${target} ${sources}/tests/conformance/conformance_test.cpp ${sources}/tests/conformance/tolerance_test.cpp)
  set(units "")
  if(list)
    add_library(${target}_integrators OBJECT ${sources}/tests/conformance/integrators_unit.cpp)
    target_compile_definitions(${target}_integrators PRIVATE POLHODE_METHODS=${list}
                                                             "POLHODE_METHODS_HEADER=\"${list_header}\"")
    list(APPEND units ${target}_integrators)
  endif()
  foreach(entry IN LISTS problems)
    polhode_entry(${entry} type header)
    string(MAKE_C_IDENTIFIER ${target}_${type} unit)
    add_library(${unit} OBJECT ${sources}/tests/conformance/problem_unit.cpp)
    target_compile_definitions(${unit} PRIVATE POLHODE_PROBLEM=${type} "POLHODE_PROBLEM_HEADER=\"${header}\"")
    list(APPEND units ${unit})
  endforeach()
  foreach(part IN LISTS target units)
    target_include_directories(${part} PRIVATE ${sources})
    # g++ spends twice the time on tests at -O3, and none of them is timed.
    target_compile_options(${part} PRIVATE ${POLHODE_WARNINGS} ${arithmetic} $<$<CONFIG:Release>:-O1>)
    target_link_libraries(${part} PRIVATE polhode::harness GTest::gtest)
  endforeach()
  target_link_libraries(${target} PRIVATE ${units} ${name}_catalog GTest::gtest_main)
  gtest_discover_tests(${target} TEST_PREFIX ${name}. DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 1800)
endfunction()
