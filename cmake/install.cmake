# Installed files and packages: cmake --install, cpack -G "DEB;TGZ", for Windows cpack -G ZIP.
include(GNUInstallDirs)

if(WIN32)
  # The program lies at the top of the folder: it needs no other file, and an editor wants it in its own folder, so that
  # is where a mapper copies it from.
  set(bin .)
  set(doc .)
  set(share .)
  set(scripts tools)
else()
  set(bin ${CMAKE_INSTALL_BINDIR})
  set(doc ${CMAKE_INSTALL_DOCDIR})
  set(share ${CMAKE_INSTALL_DATADIR}/q3map2-sh)
  set(scripts ${share}/tools)
endif()

install(TARGETS q3map2 RUNTIME_DEPENDENCY_SET libraries RUNTIME DESTINATION ${bin})
# Programs that measure, where they are built, under names that nothing else has.
function(q3_install_tool target name)
  if(TARGET ${target})
    install(TARGETS ${target} RUNTIME_DEPENDENCY_SET libraries RUNTIME DESTINATION ${bin} OPTIONAL)
    install(CODE "set(folder \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${bin}\")
if(EXISTS \"\${folder}/${target}${CMAKE_EXECUTABLE_SUFFIX}\")
  file(RENAME \"\${folder}/${target}${CMAKE_EXECUTABLE_SUFFIX}\" \"\${folder}/${name}${CMAKE_EXECUTABLE_SUFFIX}\")
endif()")
  endif()
endfunction()
q3_install_tool(shbench q3map2-shbench)
q3_install_tool(lightmap_compare q3map2-lightmap-diff)
# Scripts that measure. They stay together, as they share a module; links or, on Windows, their names call them.
install(FILES tools/measure/bsp_lumps.py DESTINATION ${scripts})
foreach(script relight_maps legacy_grid_diff)
  string(REPLACE _ - name q3map2-${script})
  if(WIN32)
    install(PROGRAMS tools/measure/${script} DESTINATION ${scripts} RENAME ${name}.py)
  else()
    install(PROGRAMS tools/measure/${script} DESTINATION ${scripts})
    file(RELATIVE_PATH there /${bin} /${scripts}/${script})
    install(CODE "file(CREATE_LINK ${there} \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${bin}/${name}\" SYMBOLIC)")
  endif()
endforeach()
# Level editors start q3map2.TYPE, where TYPE is the processor as uname -m names it; on Windows, exe.
if(NOT WIN32)
  install(CODE "file(CREATE_LINK q3map2 \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${bin}/q3map2.${CMAKE_SYSTEM_PROCESSOR}\" SYMBOLIC)")
endif()
install(FILES libs/shgrid/shgrid.h libs/shgrid/shgrid.glsl libs/shgrid/shgrid.hlsl libs/shgrid/shgrid_atlas.h
              libs/shgrid/shgrid_atlas.glsl libs/shgrid/shgrid_atlas.hlsl libs/ambientcubes/ambient_cubes.h libs/staticprops/staticprops.h
              libs/hdrlight/hdrlight.h libs/bspx/bspx.h libs/directional/directional.h libs/directional/directional.glsl
              libs/directional/directional.hlsl DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(FILES LICENSE DESTINATION ${doc})
if(Q3MAP2_MANUAL)
  install(DIRECTORY ${Q3MAP2_MANUAL}/ DESTINATION ${doc}/manual)
  # Links to pages lead to the manual: docs/guide/x.md is manual/docs/guide/x.html. Of links to sources, the text stays.
  foreach(page README.md CHANGELOG.md)
    file(READ ${page} text)
    string(REGEX REPLACE "\\]\\(((docs/[a-z0-9_/]*|docs/README|CONTRIBUTING|tools/[a-z0-9_/]*/README))[.]md"
           "](manual/\\1.html" text "${text}")
    string(REGEX REPLACE "\\]\\(docs/pictures/([^)/]*/)?([^)/]*)\\)" "](manual/_images/\\2)" text "${text}")
    string(REGEX REPLACE "\\[([^][]*)\\]\\((libs|tools)/[^)]*\\)" "\\1" text "${text}")
    file(WRITE ${CMAKE_BINARY_DIR}/generated/${page} "${text}")
    install(FILES ${CMAKE_BINARY_DIR}/generated/${page} DESTINATION ${doc})
  endforeach()
else()
  install(FILES README.md CHANGELOG.md DESTINATION ${doc})
  install(DIRECTORY docs/ DESTINATION ${doc}/docs PATTERN "*.1" EXCLUDE)
endif()
install(DIRECTORY tools/generated/editors/netradiant tools/generated/editors/gtkradiant tools/generated/editors/trenchbroom
        DESTINATION ${share}/editors)
install(FILES tools/viewer/viewer.html DESTINATION ${share})
install(DIRECTORY tools/demo_data/demo_arena tools/demo_data/demo_lights DESTINATION ${share} PATTERN make EXCLUDE)
if(NOT WIN32)
  install(FILES docs/q3map2.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
  install(FILES tools/generated/completions/q3map2.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME q3map2)
  install(FILES tools/generated/completions/_q3map2 DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
  install(FILES tools/generated/completions/q3map2.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
endif()
# Of the libraries that are linked into the program.
if(Q3MAP2_LICENCES)
  install(DIRECTORY ${Q3MAP2_LICENCES}/ DESTINATION ${share}/licences)
endif()

# The libraries of this system, with their licences, but for the C library: a part of the TGZ only (cpack_generator.cmake).
# The program looks for them below the folder that it lies in.
if(CMAKE_SYSTEM_NAME STREQUAL Linux)
  set(library_folder ${CMAKE_INSTALL_LIBDIR}/q3map2-sh)
  file(RELATIVE_PATH up /${CMAKE_INSTALL_BINDIR} /${library_folder})
  # Not the newer tag, which libraries do not use for their own libraries.
  foreach(program q3map2 shbench lightmap_compare)
    if(TARGET ${program})
      set_target_properties(${program} PROPERTIES INSTALL_RPATH "\$ORIGIN/${up}")
      target_link_options(${program} PRIVATE -Wl,--disable-new-dtags)
    endif()
  endforeach()
  install(RUNTIME_DEPENDENCY_SET libraries
          PRE_EXCLUDE_REGEXES "^ld-linux" "^lib(c|m|dl|rt|pthread)\\.so"
          LIBRARY DESTINATION ${library_folder} COMPONENT libraries EXCLUDE_FROM_ALL)
  install(CODE "set(library_folder ${library_folder})" COMPONENT libraries EXCLUDE_FROM_ALL)
  install(SCRIPT cmake/library_licences.cmake COMPONENT libraries EXCLUDE_FROM_ALL)
endif()

# Microsoft's tools link with DLLs, which lie beside the program.
if(MSVC)
  install(RUNTIME_DEPENDENCY_SET libraries PRE_EXCLUDE_REGEXES "^api-ms-" "^ext-ms-"
          POST_EXCLUDE_REGEXES "[/\\\\][Ss]ystem32[/\\\\]" RUNTIME DESTINATION ${bin})
  set(CMAKE_INSTALL_SYSTEM_RUNTIME_DESTINATION ${bin})
  include(InstallRequiredSystemLibraries)
endif()

set(CPACK_PACKAGE_NAME q3map2-sh)
set(CPACK_PACKAGE_VENDOR "q3map2-sh")
set(CPACK_PACKAGE_CONTACT "The q3map2-sh developers <q3map2-sh@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Map compiler for the Quake III Arena family with a spherical-harmonics light grid")
set(CPACK_PACKAGE_DESCRIPTION
    "Compiles map sources to BSP files, computes their visibility and bakes lightmaps, vertex light, the legacy light
grid and a light grid of L2 spherical harmonics. Its command line and files are those of q3map2.")
set(CPACK_RESOURCE_FILE_LICENSE ${CMAKE_CURRENT_SOURCE_DIR}/LICENSE)
if(WIN32)
  set(CPACK_GENERATOR ZIP)
else()
  set(CPACK_GENERATOR TGZ)
  set(CPACK_PACKAGE_FILE_NAME q3map2-sh-${PROJECT_VERSION}-${CMAKE_SYSTEM_NAME}-${CMAKE_SYSTEM_PROCESSOR})
endif()
set(CPACK_PROJECT_CONFIG_FILE ${CMAKE_CURRENT_SOURCE_DIR}/cmake/cpack_generator.cmake)
set(CPACK_STRIP_FILES ON)
set(CPACK_SOURCE_IGNORE_FILES "/build" "/demo/" "/[.]git/")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION games)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS python3) # the scripts that measure
include(CPack)
