# What an installation holds, in two components, which are two Debian packages:
#   runtime   the binaries, their data, the papers that go with them
#   dev       the header-only core; the harness as archives, headers, sources of units and tests, for polhode_add_binary
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(polhode_cmake_folder ${CMAKE_INSTALL_LIBDIR}/cmake/polhode)
set(polhode_data_folder ${CMAKE_INSTALL_DATADIR}/polhode)
set(polhode_include_folder ${CMAKE_INSTALL_INCLUDEDIR}/polhode)

# OPTIONAL: who built nothing installs the core alone.
foreach(binary IN ITEMS polhode polhode-bench)
  if(TARGET ${binary})
    install(TARGETS ${binary} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT runtime OPTIONAL)
  endif()
endforeach()
install(DIRECTORY bench/suites results/reference results/golden DESTINATION ${polhode_data_folder} COMPONENT runtime)
install(FILES LICENSE README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime)

install(TARGETS polhode_core EXPORT polhode-targets)
install(TARGETS polhode_rivals polhode_results polhode_report polhode_harness polhode_units polhode_main
        EXPORT polhode-harness-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev OPTIONAL)
install(DIRECTORY problems integrators results bench DESTINATION ${polhode_include_folder} COMPONENT dev
        FILES_MATCHING PATTERN "*.hpp" PATTERN "speed" EXCLUDE PATTERN "suites" EXCLUDE PATTERN "reference" EXCLUDE
        PATTERN "golden" EXCLUDE PATTERN "cmake" EXCLUDE)
install(DIRECTORY bench DESTINATION ${polhode_data_folder}/sources COMPONENT dev
        FILES_MATCHING PATTERN "*_unit.cpp" PATTERN "speed" EXCLUDE PATTERN "suites" EXCLUDE PATTERN "cmake" EXCLUDE)
# What polhode_add_conformance compiles.
set(conformance conformance_test.cpp tolerance_test.cpp integrators_unit.cpp problem_unit.cpp orders.hpp symmetry.hpp slopes.hpp)
set(support runs.hpp lie_group_runs.hpp pinned_runs.hpp splitting_runs.hpp)
foreach(folder IN ITEMS conformance support)
  list(TRANSFORM ${folder} PREPEND tests/${folder}/)
  install(FILES ${${folder}} DESTINATION ${polhode_data_folder}/sources/tests/${folder} COMPONENT dev)
endforeach()

foreach(set IN ITEMS polhode-targets polhode-harness-targets)
  install(EXPORT ${set} NAMESPACE polhode:: DESTINATION ${polhode_cmake_folder} COMPONENT dev)
endforeach()
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/polhode-config.cmake.in
                              ${PROJECT_BINARY_DIR}/polhode-config.cmake
                              INSTALL_DESTINATION ${polhode_cmake_folder} PATH_VARS polhode_data_folder)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/polhode-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/polhode-config.cmake ${PROJECT_BINARY_DIR}/polhode-config-version.cmake
              ${CMAKE_CURRENT_LIST_DIR}/PolhodeUnits.cmake
        DESTINATION ${polhode_cmake_folder} COMPONENT dev)

# ---- Debian packages: cpack -G DEB, in the build folder of the preset `release` ---------------------------------------
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "The Polhode authors")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_COMPONENTS_ALL runtime dev)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME polhode)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_RECOMMENDS gnuplot-nox)
set(CPACK_DEBIAN_DEV_PACKAGE_NAME polhode-dev)
find_program(POLHODE_SHLIBDEPS dpkg-shlibdeps)
if(POLHODE_SHLIBDEPS)
  set(CPACK_DEBIAN_RUNTIME_PACKAGE_SHLIBDEPS ON)
endif()
# What headers and archives are compiled and linked with: the libraries of the build.
file(STRINGS bench/packages.txt libraries REGEX "^(build|rivals) .*-dev ")
list(TRANSFORM libraries REPLACE "^[a-z]+ +([^ ]+) .*" "\\1")
list(REMOVE_ITEM libraries libgsl-dev)
list(JOIN libraries ", " libraries)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "polhode (= ${PROJECT_VERSION}), g++, cmake, ${libraries}")
set(CPACK_DEBIAN_DEV_PACKAGE_SUGGESTS libgtest-dev)
if(POLHODE_GSL)
  set(CPACK_PROJECT_CONFIG_FILE ${PROJECT_BINARY_DIR}/no-package.cmake)
  file(CONFIGURE OUTPUT ${CPACK_PROJECT_CONFIG_FILE} CONTENT
       "message(FATAL_ERROR \"This build links GSL: packages are made without (POLHODE_GSL=OFF, preset release)\")\n")
endif()
include(CPack)
