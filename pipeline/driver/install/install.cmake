# Installs the programs with their modules, man pages, completions and documents, and makes packages of them (cpack).
include(GNUInstallDirs)

set(program_targets patchlight patchlight-import patchlight-solve patchlight-trace patchlight-preview)
set(module_targets patchlight-text patchlight-embree patchlight-textures patchlight-meshes)
set_target_properties(${module_targets} PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${CMAKE_LIBRARY_OUTPUT_DIRECTORY}/patchlight)
add_dependencies(programs ${program_targets})
install(TARGETS ${program_targets} RUNTIME DESTINATION bin)
install(TARGETS ${module_targets} LIBRARY DESTINATION lib/patchlight)  # programs look in ../lib/patchlight
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright)
install(FILES ${PROJECT_SOURCE_DIR}/README.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES ${PROJECT_SOURCE_DIR}/configs/cornell_box.yaml ${PROJECT_SOURCE_DIR}/configs/cornell_box.glb
  DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples)

set(share ${CMAKE_BINARY_DIR}/share)

# Blender runs the exporter; programs look in ../share/patchlight/blender.
file(MAKE_DIRECTORY ${share}/patchlight)
file(CREATE_LINK ${PROJECT_SOURCE_DIR}/importers/blender ${share}/patchlight/blender SYMBOLIC)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/importers/blender/ DESTINATION share/patchlight/blender
  FILES_MATCHING PATTERN *.py PATTERN __pycache__ EXCLUDE)

# The add-on with the exporter, which Blender installs from its preferences.
set(addon ${share}/patchlight/patchlight_blender.zip)
file(GLOB_RECURSE addon_files CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR}/importers/blender
  ${PROJECT_SOURCE_DIR}/importers/blender/patchlight_blender/*.py)
list(TRANSFORM addon_files PREPEND ${PROJECT_SOURCE_DIR}/importers/blender/ OUTPUT_VARIABLE addon_sources)
add_custom_command(OUTPUT ${addon} DEPENDS ${addon_sources} VERBATIM COMMENT "Blender's add-on"
  WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}/importers/blender
  COMMAND ${CMAKE_COMMAND} -E tar cf ${addon} --format=zip ${addon_files})
add_custom_target(blender-addon DEPENDS ${addon})
add_dependencies(programs blender-addon)
install(FILES ${addon} DESTINATION share/patchlight)

# Every program writes its own completions.
file(MAKE_DIRECTORY ${share}/bash ${share}/zsh ${share}/man)
find_program(HELP2MAN help2man)
if(NOT HELP2MAN)
  message(STATUS "No help2man: no man pages")
endif()
set(run ${CMAKE_COMMAND} -E env ASAN_OPTIONS=detect_leaks=0)
foreach(program IN LISTS program_targets)
  set(outputs ${share}/bash/${program} ${share}/zsh/_${program})
  add_custom_command(OUTPUT ${outputs} DEPENDS ${program} VERBATIM COMMENT "Completions of ${program}"
    COMMAND ${run} $<TARGET_FILE:${program}> --completion bash > ${share}/bash/${program}
    COMMAND ${run} $<TARGET_FILE:${program}> --completion zsh > ${share}/zsh/_${program})
  if(HELP2MAN)
    add_custom_command(OUTPUT ${share}/man/${program}.1 VERBATIM COMMENT "Man page of ${program}"
      DEPENDS ${program} ${PROJECT_SOURCE_DIR}/pipeline/driver/install/write_man_page
      COMMAND ${run} ${PROJECT_SOURCE_DIR}/pipeline/driver/install/write_man_page ${HELP2MAN} $<TARGET_FILE:${program}> ${PROJECT_VERSION}
      ${share}/man/${program}.1)
    list(APPEND outputs ${share}/man/${program}.1)
  endif()
  add_custom_target(${program}-documents DEPENDS ${outputs})
  add_dependencies(programs ${program}-documents)
endforeach()
install(DIRECTORY ${share}/bash/ DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
install(DIRECTORY ${share}/zsh/ DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
install(DIRECTORY ${share}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)

set(CPACK_GENERATOR TGZ DEB)
set(CPACK_PACKAGE_NAME patchlight)
set(CPACK_PACKAGE_CONTACT "the Patchlight developers <patchlight@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Global illumination for batch work: radiosity from glTF scenes")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "libegl1, libopengl0, libgl1-mesa-dri")  # opened by name, where hemicubes are drawn
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS gnuplot-nox)
include(CPack)
