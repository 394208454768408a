# What is installed: the command, the variants that were built, headers and CMake functions for
# solvers outside this tree, figures' recipes, plans, manual, completion. `cpack -G DEB` packs it.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(share ${CMAKE_INSTALL_DATADIR}/sphbench)
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/sphbench)

install(TARGETS sphbench RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
foreach(variant ${variants} ${cuda_variants}) # those that are not built are not missed
  install(TARGETS sphbench-${variant} RUNTIME DESTINATION libexec/sphbench OPTIONAL)
endforeach()
foreach(program ${programs})
  install(TARGETS ${program} RUNTIME DESTINATION libexec/sphbench)
endforeach()
install(PROGRAMS tools/new-solver DESTINATION ${CMAKE_INSTALL_BINDIR} RENAME sphbench-new-solver)
install(DIRECTORY tools/plugin-template DESTINATION ${share})
install(DIRECTORY core DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/sphbench
  FILES_MATCHING PATTERN "*.h" PATTERN "fields.def"
  PATTERN "run" EXCLUDE PATTERN "io" EXCLUDE PATTERN "scene" EXCLUDE)
install(FILES solvers/solvers.def DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/sphbench/solvers)
install(DIRECTORY benchmarks DESTINATION ${share} FILES_MATCHING PATTERN "*.yaml")
install(DIRECTORY paper-figures DESTINATION ${share})
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR} FILES_MATCHING PATTERN "*.md"
  PATTERN "*.yml")
install(FILES docs/sphbench.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES tools/completion/sphbench.bash RENAME sphbench
  DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
install(FILES tools/completion/_sphbench
  DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)

# Plug-ins are compiled as the engine is, or they would not give the same bits.
list(JOIN engine_flags " " engine_flags_text)
configure_package_config_file(cmake/sphbenchConfig.cmake.in
  ${CMAKE_BINARY_DIR}/package/sphbenchConfig.cmake INSTALL_DESTINATION ${package_folder}
  PATH_VARS CMAKE_INSTALL_INCLUDEDIR CMAKE_INSTALL_BINDIR)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/package/sphbenchConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/package/sphbenchConfig.cmake
  ${CMAKE_BINARY_DIR}/package/sphbenchConfigVersion.cmake DESTINATION ${package_folder})
file(RELATIVE_PATH from_pc /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
configure_file(cmake/sphbench.pc.in ${CMAKE_BINARY_DIR}/package/sphbench.pc @ONLY)
install(FILES ${CMAKE_BINARY_DIR}/package/sphbench.pc
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

set(CPACK_PACKAGE_NAME sphbench)
set(CPACK_PACKAGE_CONTACT "the sphbench maintainers <maintainers@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY
  "compares pressure solvers for smoothed particle hydrodynamics")
set(CPACK_RESOURCE_FILE_LICENSE ${CMAKE_SOURCE_DIR}/LICENSE)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS gnuplot-nox)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_STRIP_FILES ON)
include(CPack)
