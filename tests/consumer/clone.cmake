# Follows what the READMEs of integrators/ and problems/ say of a clone: a header and a line for an integrator, and for
# a problem, in a copy of the sources; then both are listed, run, checked, reported, and pass the conformance tests.
# Only what the two lines change is compiled: the copy has the flags of the build under test, and its compiler cache.
#   cmake -D build=FOLDER -D sources=FOLDER -D generator=NAME -D compiler=FILE -D "flags=FLAGS" -D type=BUILD_TYPE
#         -D gsl=BOOL -D sundials=BOOL -P clone.cmake
set(work ${build}/follow-clone)
set(tree ${work}/tree)
file(REMOVE_RECURSE ${work})
file(MAKE_DIRECTORY ${tree})
include(${CMAKE_CURRENT_LIST_DIR}/steps.cmake)

# ---- Copy what git knows --------------------------------------------------------------------------------------------
execute_process(COMMAND git ls-files -z --cached --others --exclude-standard COMMAND tar --null -cT - COMMAND tar -xC ${tree}
                WORKING_DIRECTORY ${sources} COMMAND_ERROR_IS_FATAL ANY)

# ---- A header and a line each ---------------------------------------------------------------------------------------
# In `file`: after `first` comes `added`, below the include of `above` that of `header`.
function(add_line file first added above header)
  file(READ ${tree}/${file} text)
  string(REPLACE "${first}" "${first}${added}" text "${text}")
  string(REPLACE "#include \"${above}\"\n" "#include \"${above}\"\n#include \"${header}\"\n" text "${text}")
  expect("${text}" "${added}")
  expect("${text}" "${header}")
  file(WRITE ${tree}/${file} "${text}")
endfunction()
code_block(integrators/README.md tests/consumer/heun.hpp text)
file(WRITE ${tree}/integrators/heun.hpp "${text}")
add_line(integrators/catalog/explicit.hpp "struct ExplicitMethods : Types<Rk4, Dopri5, " "Heun, "
         integrators/catalog/lists.hpp integrators/heun.hpp)
code_block(problems/README.md tests/consumer/damped_body.hpp text)
file(WRITE ${tree}/problems/damped_body.hpp "${text}")
add_line(problems/catalog.hpp "using OtherProblems = Types<\n    HeavyTop,\n" "    DampedBody,\n"
         problems/coning.hpp problems/damped_body.hpp)

# ---- Build, and do as they say --------------------------------------------------------------------------------------
# The cache counts paths from the sources: the copy's build folder lies in it as the other one does in its own.
cmake_path(IS_PREFIX sources ${build} inside)
set(copy ${tree}/build/copy)
if(inside)
  cmake_path(RELATIVE_PATH build BASE_DIRECTORY ${sources} OUTPUT_VARIABLE folder)
  set(copy ${tree}/${folder})
endif()
must(${CMAKE_COMMAND} -S ${tree} -B ${copy} -G ${generator} -D CMAKE_CXX_COMPILER=${compiler} -D CMAKE_BUILD_TYPE=${type}
     -D CMAKE_CXX_FLAGS=${flags} -D POLHODE_GSL=${gsl} -D POLHODE_SUNDIALS=${sundials})
must(${CMAKE_COMMAND} --build ${copy} --target polhode conformance)

file(WRITE ${work}/toys.toml "name = 'toys'
timing = { enabled = false }
[[sweep]]
problem = ['free_body', 'damped_body']
formulation = 'quaternion'
integrator = ['heun', 'rk4']
h = { logspace = [0.0125, 0.1], count = 4 }
t_end = 10
[[expect]]
select = { integrator = 'heun' }
order = { nominal = true }
min_cells = 8
")
code_block(integrators/README.md clone text)
code_block(problems/README.md clone more)
file(WRITE ${work}/commands.sh "set -e -x
PATH=${copy}/bench:$PATH
polhode list integrators
polhode list problems
${text}${more}
polhode run toys.toml --out results
polhode check results
polhode report results
")
execute_process(COMMAND bash commands.sh WORKING_DIRECTORY ${work} OUTPUT_VARIABLE output ECHO_OUTPUT_VARIABLE
                COMMAND_ERROR_IS_FATAL ANY)
foreach(word IN ITEMS "\nheun " "\ndamped_body: " "16 cells: 16 ok" "1 checks: 1 passed")
  expect("${output}" "${word}")
endforeach()
file(READ ${work}/results/report/tables/integrators.csv orders)
expect("${orders}" "\nheun,explicit_rk,2,(2[.]0|1[.]9)")
file(READ ${work}/results/report/report.md report)
expect("${report}" "damped_body")

# Everything that walks the catalogues, but for the references: a minute of certifying those that the copy has not
# changed.
must(${CMAKE_CTEST_COMMAND} --test-dir ${copy}/tests -R "^(Order|Symmetry)[.]OfTheExplicitMethods|^(Catalogue|Preserves|TimedRuns|Tolerance)[.]"
     --no-tests=error --output-on-failure)
