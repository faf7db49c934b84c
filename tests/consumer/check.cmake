# Installs the build folder into a temporary prefix, builds the consumer against it and runs what came out.
#   cmake -D build=FOLDER -D config=NAME -D generator=NAME -D compiler=FILE -P check.cmake
set(work ${build}/consumer)
file(REMOVE_RECURSE ${work})
include(${CMAKE_CURRENT_LIST_DIR}/steps.cmake)

must(${CMAKE_COMMAND} --install ${build} --config ${config} --prefix ${work}/prefix)
must(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR} -B ${work}/build -G ${generator} -D CMAKE_CXX_COMPILER=${compiler}
     -D CMAKE_BUILD_TYPE=Release -D CMAKE_PREFIX_PATH=${work}/prefix)
must(${CMAKE_COMMAND} --build ${work}/build)
must(${work}/build/main)
must(${work}/build/examples)
if(EXISTS ${work}/prefix/bin/polhode)
  must(${work}/prefix/bin/polhode --version)
endif()
