# Follows what the READMEs of integrators/ and problems/ say of a project of one's own: their code blocks are put in
# place, their commands are run with an installed Polhode, and what they promise is looked for. Then a wrong claim must
# fail. (In a clone: clone.cmake.)
#   cmake -D build=FOLDER -D sources=FOLDER -D generator=NAME -D compiler=FILE -D launcher=COMMAND
#         -D from=install|deb -P follow.cmake
# from=deb makes packages in a build folder of their own, FOLDER-package, and unpacks them.
set(work ${build}/follow-${from})
set(project ${work}/project)
file(REMOVE_RECURSE ${work})
file(MAKE_DIRECTORY ${project})
include(${CMAKE_CURRENT_LIST_DIR}/steps.cmake)

# ---- Install --------------------------------------------------------------------------------------------------------
if(from STREQUAL deb)
  set(package ${build}-package)
  must(${CMAKE_COMMAND} -S ${sources} -B ${package} -G ${generator} -D CMAKE_CXX_COMPILER=${compiler}
       -D CMAKE_BUILD_TYPE=Release -D POLHODE_GSL=OFF -D POLHODE_MPI=OFF -D POLHODE_TESTS=OFF)
  must(${CMAKE_COMMAND} --build ${package})
  file(GLOB old ${package}/*.deb)
  if(old)
    file(REMOVE ${old})
  endif()
  execute_process(COMMAND ${CMAKE_CPACK_COMMAND} -G DEB WORKING_DIRECTORY ${package} COMMAND_ERROR_IS_FATAL ANY)
  file(GLOB packages ${package}/*.deb)
  foreach(file IN LISTS packages)
    must(dpkg-deb --info ${file})
    must(dpkg-deb -x ${file} ${work}/prefix)
  endforeach()
  set(prefix ${work}/prefix/usr)
else()
  set(prefix ${work}/prefix)
  must(${CMAKE_COMMAND} --install ${build} --prefix ${prefix})
endif()

# ---- Put the blocks in place ----------------------------------------------------------------------------------------
foreach(name IN ITEMS heun.hpp plugin/CMakeLists.txt plugin/mine.toml)
  code_block(integrators/README.md tests/consumer/${name} text)
  cmake_path(GET name FILENAME file)
  file(WRITE ${project}/${file} "${text}")
endforeach()
code_block(problems/README.md tests/consumer/damped_body.hpp text)
file(WRITE ${project}/damped_body.hpp "${text}")
code_block(integrators/README.md commands text)
file(WRITE ${project}/commands.sh "${text}")

# ---- Do as they say -------------------------------------------------------------------------------------------------
execute_process(COMMAND ${CMAKE_COMMAND} -E env CMAKE_PREFIX_PATH=${prefix} CMAKE_GENERATOR=${generator} CXX=${compiler}
                        CMAKE_CXX_COMPILER_LAUNCHER=${launcher} CCACHE_BASEDIR=${work} CCACHE_NOHASHDIR=1
                        bash -e -x commands.sh
                WORKING_DIRECTORY ${project} OUTPUT_VARIABLE output ECHO_OUTPUT_VARIABLE COMMAND_ERROR_IS_FATAL ANY)

foreach(word IN ITEMS "\nrk4 " "\nheun " "\nlie_midpoint " "\nfree_body: " "\ndamped_body: " "48 cells: 24 ok, 24 refused"
                      "2 checks: 2 passed" "100% tests passed")
  expect("${output}" "${word}")
endforeach()
file(READ ${project}/damped.csv trajectory)
expect("${trajectory}" "damped_body")
# Orders in the report: nominal 2, measured 2.
file(READ ${project}/results/report/tables/integrators.csv orders)
expect("${orders}" "\nheun,explicit_rk,2,(2[.]0|1[.]9)")
expect("${orders}" "\nlie_midpoint,lie_group,2,(2[.]0|1[.]9)")
file(READ ${project}/results/report/report.md report)
expect("${report}" "damped_body")
file(GLOB records ${project}/results/*.jsonl)
file(STRINGS ${records} timed REGEX "\"problem\":\"free_body\".*\"integrator\":\"heun\".*\"status\":\"ok\".*\"median\":[0-9]")
expect("${timed}" "heun")
if(from STREQUAL deb)  # the lines above have shown that the package is whole
  must(${prefix}/bin/polhode --version)
  return()
endif()

# ---- Claim too much -------------------------------------------------------------------------------------------------
file(READ ${project}/heun.hpp header)
string(REPLACE ".family = Family::explicit_rk, .order = 2" ".family = Family::explicit_rk, .order = 3" wrong "${header}")
if(wrong STREQUAL header)
  message(FATAL_ERROR "heun.hpp claims nothing that could be changed")
endif()
file(WRITE ${project}/heun.hpp "${wrong}")
must(${CMAKE_COMMAND} --build ${project}/build --target my_polhode_conformance)
execute_process(COMMAND ${CMAKE_CTEST_COMMAND} --test-dir ${project}/build -R "my_polhode[.]Order" --output-on-failure
                OUTPUT_VARIABLE output RESULT_VARIABLE code)
if(code EQUAL 0)
  message(FATAL_ERROR "a wrong order passes:\n${output}")
endif()
expect("${output}" "heun on shaken slew as quaternion")
