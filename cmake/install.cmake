# What `cmake --install` puts down, and how others find it: find_package(raymap) and pkg-config.
include(CMakePackageConfigHelpers)

# Packages the library links but never shows in a header: a static library hands them on, a shared one does not.
set(RAYMAP_PRIVATE_PACKAGES Threads TBB hwy PNG ZLIB Imath)
set(RAYMAP_PRIVATE_PKGCONFIG "tbb libhwy-contrib libhwy libpng zlib pugixml minizip Imath")

get_property(layers GLOBAL PROPERTY RAYMAP_LAYERS)
list(TRANSFORM layers PREPEND raymap_ OUTPUT_VARIABLE layers)
if(BUILD_SHARED_LIBS)
  set(layers "")
  set_target_properties(raymap PROPERTIES VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
endif()
install(TARGETS raymap ${layers} EXPORT raymapTargets)
install(DIRECTORY include/raymap DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} PATTERN vulkan.h EXCLUDE)
if(RAYMAP_VULKAN)
  install(FILES include/raymap/vulkan.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/raymap)
endif()

set(RAYMAP_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/raymap)
configure_package_config_file(cmake/raymapConfig.cmake.in raymapConfig.cmake INSTALL_DESTINATION ${RAYMAP_CMAKE_DIR})
write_basic_package_version_file(raymapConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(EXPORT raymapTargets NAMESPACE raymap:: DESTINATION ${RAYMAP_CMAKE_DIR})
install(FILES ${PROJECT_BINARY_DIR}/raymapConfig.cmake ${PROJECT_BINARY_DIR}/raymapConfigVersion.cmake
  DESTINATION ${RAYMAP_CMAKE_DIR})

file(RELATIVE_PATH RAYMAP_PREFIX_FROM_PC /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
configure_file(cmake/raymap.pc.in raymap.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/raymap.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
