# What an installation holds: the header-only core with its package files, and the binaries with their data, if built.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(polhode_cmake_folder ${CMAKE_INSTALL_LIBDIR}/cmake/polhode)

install(TARGETS polhode_core EXPORT polhode-targets)
install(DIRECTORY problems integrators DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/polhode FILES_MATCHING PATTERN "*.hpp")
install(EXPORT polhode-targets NAMESPACE polhode:: DESTINATION ${polhode_cmake_folder})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/polhode-config.cmake.in
                              ${PROJECT_BINARY_DIR}/polhode-config.cmake
                              INSTALL_DESTINATION ${polhode_cmake_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/polhode-config-version.cmake COMPATIBILITY SameMinorVersion
                                 ARCH_INDEPENDENT)
install(FILES ${PROJECT_BINARY_DIR}/polhode-config.cmake ${PROJECT_BINARY_DIR}/polhode-config-version.cmake
        DESTINATION ${polhode_cmake_folder})

foreach(binary IN ITEMS polhode polhode-bench)
  if(TARGET ${binary})
    install(TARGETS ${binary} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} OPTIONAL)
  endif()
endforeach()
foreach(data IN ITEMS bench/suites results/reference results/golden)
  if(EXISTS ${PROJECT_SOURCE_DIR}/${data})
    install(DIRECTORY ${data} DESTINATION ${CMAKE_INSTALL_DATADIR}/polhode)
  endif()
endforeach()
install(FILES LICENSE README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
