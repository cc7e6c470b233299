# cmake --install: the program, its samples and presets, the manual, manual pages, completion scripts, and what
# a desktop needs to list it and to open NC programs with it. On Windows, one folder that can lie anywhere.
if(WIN32)
  set(bin .)
  set(data share/feeler)
  set(doc doc)
  set(texts .)
else()
  include(GNUInstallDirs)
  set(bin ${CMAKE_INSTALL_BINDIR})
  set(data ${CMAKE_INSTALL_DATADIR}/feeler)
  set(doc ${CMAKE_INSTALL_DOCDIR})
  set(texts ${doc})
endif()
install(TARGETS feeler RUNTIME DESTINATION ${bin})
install(DIRECTORY assets/holders assets/machines assets/meshes assets/programs assets/setups
  DESTINATION ${data} PATTERN "*.py" EXCLUDE)
install(DIRECTORY docs/manual docs/images DESTINATION ${doc})
install(FILES README.md LICENSE DESTINATION ${texts})

# The fonts, for archives that need nothing installed.
set(fonts /usr/share/fonts)
install(FILES
    ${fonts}/opentype/inter/Inter-Regular.otf ${fonts}/opentype/inter/Inter-SemiBold.otf
    ${fonts}/opentype/inter/InterDisplay-SemiBold.otf ${fonts}/truetype/jetbrains-mono/JetBrainsMono-Regular.ttf
    ${fonts}/truetype/font-awesome/fontawesome-webfont.ttf
  DESTINATION ${data}/fonts COMPONENT fonts EXCLUDE_FROM_ALL)

if(WIN32)
  install(FILES assets/desktop/open-with.cmd DESTINATION .)
  install(FILES ${FEELER_DEPS_LICENCES} DESTINATION licences)
  install(FILES core/base/libm/COPYRIGHT DESTINATION licences RENAME musl.txt)
  foreach(font fonts-inter fonts-jetbrains-mono fonts-font-awesome)
    install(FILES /usr/share/doc/${font}/copyright DESTINATION licences RENAME ${font}.txt)
  endforeach()
  return()
endif()

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
