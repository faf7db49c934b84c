# Runs on several ranks (bench/job/mpi.cpp). By default on where MPI is found: a binary without it can only say so under
# mpirun, and MPI costs a run without mpirun nothing but its loading (1.2 ms). Packages are made without it (preset
# release), or every user would have to install it.
if(NOT DEFINED POLHODE_MPI OR POLHODE_MPI)
  set(MPI_CXX_SKIP_MPICXX ON)
  find_package(MPI QUIET COMPONENTS CXX)
endif()
option(POLHODE_MPI "Spread runs over the ranks of an MPI job" ${MPI_CXX_FOUND})
if(NOT POLHODE_MPI)
  return()
endif()
if(NOT MPI_CXX_FOUND)
  message(FATAL_ERROR "POLHODE_MPI is ON, but there is no MPI: install openmpi-bin and libopenmpi-dev")
endif()
list(TRANSFORM MPI_CXX_INCLUDE_DIRS PREPEND -isystem OUTPUT_VARIABLE includes)
set_source_files_properties(${PROJECT_SOURCE_DIR}/bench/job/mpi.cpp TARGET_DIRECTORY polhode_harness PROPERTIES
                            COMPILE_DEFINITIONS "POLHODE_HAS_MPI;OMPI_SKIP_MPICXX;MPICH_SKIP_MPICXX"
                            COMPILE_OPTIONS "${includes}")
# Files, not the imported target: one source needs its flags, and who uses the installed harness need not find MPI.
target_link_libraries(polhode_harness PRIVATE ${MPI_CXX_LIBRARIES})
