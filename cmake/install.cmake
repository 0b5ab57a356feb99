# Headers, and what CMake and pkg-config find them by: no file depends on the machine or says where it was installed, so
# all of it lies in share.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

install(TARGETS mica EXPORT micaTargets INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY include/mica DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN *.hpp)

set(package ${CMAKE_INSTALL_DATADIR}/cmake/mica)
install(EXPORT micaTargets FILE micaConfig.cmake NAMESPACE mica:: DESTINATION ${package})
write_basic_package_version_file(micaConfigVersion.cmake COMPATIBILITY SameMinorVersion ARCH_INDEPENDENT)
install(FILES ${PROJECT_BINARY_DIR}/micaConfigVersion.cmake DESTINATION ${package})

file(RELATIVE_PATH prefix_from_pc /${CMAKE_INSTALL_DATADIR}/pkgconfig /)
string(REGEX REPLACE "/$" "" prefix_from_pc ${prefix_from_pc})
configure_file(cmake/mica.pc.in mica.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/mica.pc DESTINATION ${CMAKE_INSTALL_DATADIR}/pkgconfig)
