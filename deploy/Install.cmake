# Where everything lies on a computer, and the Debian package. Programs install themselves (lookout_program in cmake/Rooms.cmake).
set(data_folder ${CMAKE_INSTALL_DATADIR}/lookout)
install(PROGRAMS ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/lookout-up DESTINATION ${CMAKE_INSTALL_BINDIR})
install(PROGRAMS backoff DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/lookout)
# Programs that are scripts, and Java archives, by their names alone: whoever makes one need not come here.
install(CODE "
  file(GLOB scripts \"${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/lookout-*\")
  foreach(script IN LISTS scripts)
    file(READ \"\${script}\" magic LIMIT 2)
    if(magic MATCHES \"^#!\")
      file(INSTALL \"\${script}\" DESTINATION \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_BINDIR}\" USE_SOURCE_PERMISSIONS)
    endif()
  endforeach()
  file(GLOB archives \"${CMAKE_BINARY_DIR}/lookout-*.jar\")
  file(INSTALL \${archives} DESTINATION \"\${CMAKE_INSTALL_PREFIX}/${data_folder}\")
")
install(DIRECTORY ${CMAKE_SOURCE_DIR}/lcmtypes DESTINATION ${data_folder} FILES_MATCHING PATTERN "*.lcm" PATTERN "java" EXCLUDE)
# Boats to copy, and scenes for lookout-sim; what is in /etc is the boat's own.
install(DIRECTORY ${CMAKE_SOURCE_DIR}/config/demo ${CMAKE_SOURCE_DIR}/config/catabot ${CMAKE_SOURCE_DIR}/config/scenes DESTINATION ${data_folder}/config)
install(DIRECTORY ${CMAKE_SOURCE_DIR}/config/schema DESTINATION ${data_folder}/config FILES_MATCHING PATTERN "*.proto")
install(DIRECTORY ${CMAKE_SOURCE_DIR}/config/catabot/ DESTINATION ${CMAKE_INSTALL_FULL_SYSCONFDIR}/lookout/boat)
install(FILES default DESTINATION ${CMAKE_INSTALL_FULL_SYSCONFDIR}/default RENAME lookout)
# systemd looks below /usr/lib whatever the architecture.
install(DIRECTORY ${units_folder}/ DESTINATION lib/systemd/system)
install(FILES systemd/sysusers.conf DESTINATION lib/sysusers.d RENAME lookout.conf)
install(FILES systemd/sysctl.conf DESTINATION lib/sysctl.d RENAME 60-lookout.conf)
install(FILES README.md ${CMAKE_SOURCE_DIR}/TROUBLESHOOTING.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES systemd/live-capture.conf DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples)
install(FILES ${CMAKE_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright)

# The package. Its conffiles are all that lies in /etc: changed ones are kept at an upgrade.
file(GLOB boat_files RELATIVE ${CMAKE_SOURCE_DIR}/config/catabot CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/config/catabot/*.txtpb)
set(conffiles "/etc/default/lookout\n")
foreach(file ${boat_files})
  string(APPEND conffiles "/etc/lookout/boat/${file}\n")
endforeach()
file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/debian/conffiles "${conffiles}")
foreach(script postinst prerm postrm)
  configure_file(debian/${script} ${CMAKE_CURRENT_BINARY_DIR}/debian/${script} COPYONLY
                 FILE_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
endforeach()
# Debian wants the changelog compressed, without the time of compression.
execute_process(COMMAND gzip -9n INPUT_FILE ${CMAKE_SOURCE_DIR}/CHANGELOG.md OUTPUT_FILE ${CMAKE_CURRENT_BINARY_DIR}/changelog.gz)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/changelog.gz DESTINATION ${CMAKE_INSTALL_DOCDIR})

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME lookout)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_DIRECTORY ${CMAKE_BINARY_DIR}/package)
set(CPACK_PACKAGE_CONTACT "The Lookout maintainers <maintainers@users.noreply.lookout.example>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "lidar look-out for small boats")
set(CPACK_PACKAGE_DESCRIPTION "A suite of processes on an LCM bus: packets of a Velodyne VLP-16 come in, every\nobstacle on the water is segmented, placed on the earth with GNSS and\nattitude, and logged so that the same bytes can be computed again.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# ip for the route, sysctl for the buffers, kill for reloads, sysusers for the user: of systemd, or alone where there is none.
set(CPACK_DEBIAN_PACKAGE_DEPENDS "iproute2, procps, systemd | systemd-standalone-sysusers | systemd-sysusers")
# lookout-spy, and LCM's own tools; a boat does without.
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "liblcm-bin")
# lookout-up, where there is no systemd. Not recommended: runit's own recommendation would start a second supervisor on the boat.
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "runit, default-jre, liblcm-java, libjchart2d-java")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(control_folder ${CMAKE_CURRENT_BINARY_DIR}/debian)
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA "${control_folder}/conffiles;${control_folder}/postinst;${control_folder}/prerm;${control_folder}/postrm")
include(CPack)
