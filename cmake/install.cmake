# cmake --install: the program, its samples and presets, the manual, manual pages, completion scripts, and what
# a desktop needs to list it and to open NC programs with it.
include(GNUInstallDirs)

install(TARGETS feeler RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY assets/holders assets/machines assets/meshes assets/programs assets/setups
  DESTINATION ${CMAKE_INSTALL_DATADIR}/feeler PATTERN "*.py" EXCLUDE)
install(DIRECTORY docs/manual docs/images DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES README.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES assets/desktop/feeler.desktop DESTINATION ${CMAKE_INSTALL_DATADIR}/applications)
install(FILES assets/desktop/feeler.svg DESTINATION ${CMAKE_INSTALL_DATADIR}/icons/hicolor/scalable/apps)
install(FILES assets/desktop/feeler.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/mime/packages)
install(FILES assets/desktop/io.github.feeler.metainfo.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/metainfo)

# The program writes its manual pages and completion scripts itself, from the texts of --help.
set(help ${PROJECT_BINARY_DIR}/help)
install(CODE "
  file(MAKE_DIRECTORY \"${help}/man\")
  execute_process(COMMAND \"$<TARGET_FILE:feeler>\" man-pages \"${help}/man\" COMMAND_ERROR_IS_FATAL ANY)
  foreach(shell bash zsh fish)
    execute_process(COMMAND \"$<TARGET_FILE:feeler>\" completion \${shell}
      OUTPUT_FILE \"${help}/completion.\${shell}\" COMMAND_ERROR_IS_FATAL ANY)
  endforeach()")
install(DIRECTORY ${help}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES ${help}/completion.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME feeler)
install(FILES ${help}/completion.zsh DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions RENAME _feeler)
install(FILES ${help}/completion.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d
  RENAME feeler.fish)
