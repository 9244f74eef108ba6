# Installed files and packages: cmake --install, cpack -G "DEB;TGZ".
include(GNUInstallDirs)

install(TARGETS q3map2 RUNTIME_DEPENDENCY_SET libraries RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
# Level editors start q3map2.TYPE, where TYPE is the processor as uname -m names it; on Windows, exe.
if(NOT WIN32)
  install(CODE "file(CREATE_LINK q3map2 \$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_BINDIR}/q3map2.${CMAKE_SYSTEM_PROCESSOR} SYMBOLIC)")
endif()
install(FILES libs/shgrid/shgrid.h libs/shgrid/shgrid.glsl libs/shgrid/shgrid.hlsl libs/shgrid/shgrid_atlas.h
              libs/shgrid/shgrid_atlas.glsl libs/shgrid/shgrid_atlas.hlsl libs/ambientcubes/ambient_cubes.h libs/staticprops/staticprops.h
              libs/hdrlight/hdrlight.h libs/bspx/bspx.h libs/directional/directional.h libs/directional/directional.glsl
              libs/directional/directional.hlsl DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(FILES README.md CHANGELOG.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/docs PATTERN "*.1" EXCLUDE)
install(FILES docs/q3map2.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES tools/generated/completions/q3map2.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME q3map2)
install(FILES tools/generated/completions/_q3map2 DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
install(FILES tools/generated/completions/q3map2.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
install(DIRECTORY tools/generated/editors/netradiant tools/generated/editors/gtkradiant tools/generated/editors/trenchbroom
        DESTINATION ${CMAKE_INSTALL_DATADIR}/q3map2-sh/editors)
install(FILES tools/viewer/viewer.html DESTINATION ${CMAKE_INSTALL_DATADIR}/q3map2-sh)
install(DIRECTORY tools/demo_data/demo_arena tools/demo_data/demo_lights DESTINATION ${CMAKE_INSTALL_DATADIR}/q3map2-sh PATTERN make EXCLUDE)

# The libraries of this system, with their licences, but for the C library: a part of the TGZ only (cpack_generator.cmake).
# The program looks for them below the folder that it lies in.
if(CMAKE_SYSTEM_NAME STREQUAL Linux)
  set(library_folder ${CMAKE_INSTALL_LIBDIR}/q3map2-sh)
  file(RELATIVE_PATH up /${CMAKE_INSTALL_BINDIR} /${library_folder})
  # Not the newer tag, which libraries do not use for their own libraries.
  set_target_properties(q3map2 PROPERTIES INSTALL_RPATH "\$ORIGIN/${up}")
  target_link_options(q3map2 PRIVATE -Wl,--disable-new-dtags)
  install(RUNTIME_DEPENDENCY_SET libraries
          PRE_EXCLUDE_REGEXES "^ld-linux" "^lib(c|m|dl|rt|pthread)\\.so"
          LIBRARY DESTINATION ${library_folder} COMPONENT libraries EXCLUDE_FROM_ALL)
  install(CODE "set(library_folder ${library_folder})" COMPONENT libraries EXCLUDE_FROM_ALL)
  install(SCRIPT cmake/library_licences.cmake COMPONENT libraries EXCLUDE_FROM_ALL)
endif()

set(CPACK_PACKAGE_NAME q3map2-sh)
set(CPACK_PACKAGE_VENDOR "q3map2-sh")
set(CPACK_PACKAGE_CONTACT "The q3map2-sh developers <q3map2-sh@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Map compiler for the Quake III Arena family with a spherical-harmonics light grid")
set(CPACK_PACKAGE_DESCRIPTION
    "Compiles map sources to BSP files, computes their visibility and bakes lightmaps, vertex light, the legacy light
grid and a light grid of L2 spherical harmonics. Its command line and files are those of q3map2.")
set(CPACK_RESOURCE_FILE_LICENSE ${CMAKE_CURRENT_SOURCE_DIR}/LICENSE)
set(CPACK_GENERATOR TGZ)
set(CPACK_PROJECT_CONFIG_FILE ${CMAKE_CURRENT_SOURCE_DIR}/cmake/cpack_generator.cmake)
set(CPACK_STRIP_FILES ON)
set(CPACK_SOURCE_IGNORE_FILES "/build" "/demo/" "/[.]git/")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION games)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
include(CPack)
