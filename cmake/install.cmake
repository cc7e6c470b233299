# cmake --install: the program, its samples and presets, the manual, the licences, manual pages, completion scripts, and
# what a desktop needs to list it and to open NC programs with it. On Windows, one folder that can lie anywhere.
if(WIN32)
  set(bin .)
  set(data share/feeler)
  set(texts .)
  set(licences licences)
else()
  include(GNUInstallDirs)
  set(bin ${CMAKE_INSTALL_BINDIR})
  set(data ${CMAKE_INSTALL_DATADIR}/feeler)
  set(texts ${CMAKE_INSTALL_DOCDIR})
  set(licences ${texts}/licences)
endif()
install(TARGETS feeler RUNTIME DESTINATION ${bin})
if(FEELER_HAS_OPENCASCADE)
  install(TARGETS feeler-cad RUNTIME DESTINATION lib/feeler)
endif()
install(DIRECTORY assets/holders assets/machines assets/meshes assets/programs assets/setups
  DESTINATION ${data} PATTERN "*.py" EXCLUDE)
install(FILES assets/README.md DESTINATION ${data})
install(FILES assets/linuxcnc/feeler_status.py DESTINATION ${data}/linuxcnc)
install(DIRECTORY assets/linuxcnc/feeler_tp DESTINATION ${data}/linuxcnc)

cmake_path(ABSOLUTE_PATH texts BASE_DIRECTORY /prefix NORMALIZE OUTPUT_VARIABLE from)
cmake_path(ABSOLUTE_PATH data BASE_DIRECTORY /prefix NORMALIZE OUTPUT_VARIABLE to)
file(RELATIVE_PATH samples ${from} ${to})
set(documents ${PROJECT_BINARY_DIR}/documents)
install(CODE "
  execute_process(COMMAND \"${CMAKE_COMMAND}\" -D \"SOURCE=${PROJECT_SOURCE_DIR}\" -D \"OUTPUT=${documents}\"
    -D \"SAMPLES=${samples}\" -P \"${PROJECT_SOURCE_DIR}/cmake/documents.cmake\" COMMAND_ERROR_IS_FATAL ANY)")
install(DIRECTORY ${documents}/ DESTINATION ${texts})
install(FILES LICENSE DESTINATION ${texts})

# The licences of what is compiled into the program.
install(FILES core/base/libm/COPYRIGHT DESTINATION ${licences} RENAME musl.txt)
install(FILES ${PROJECT_BINARY_DIR}/app/report/html/view/node_modules/three/LICENSE
  DESTINATION ${licences} RENAME three.js.txt OPTIONAL)
if(WIN32)
  install(FILES ${FEELER_DEPS_LICENCES} DESTINATION ${licences})
else()
  foreach(package libasio-dev libcli11-dev libexpected-dev libglm-dev libimgui-dev nlohmann-json3-dev)
    install(FILES /usr/share/doc/${package}/copyright DESTINATION ${licences} RENAME ${package}.txt OPTIONAL)
  endforeach()
endif()

# The fonts, for archives that need nothing installed.
set(fonts /usr/share/fonts)
install(FILES
    ${fonts}/opentype/inter/Inter-Regular.otf ${fonts}/opentype/inter/Inter-SemiBold.otf
    ${fonts}/opentype/inter/InterDisplay-SemiBold.otf ${fonts}/truetype/jetbrains-mono/JetBrainsMono-Regular.ttf
    ${fonts}/truetype/font-awesome/fontawesome-webfont.ttf
  DESTINATION ${data}/fonts COMPONENT fonts EXCLUDE_FROM_ALL)
foreach(font fonts-inter fonts-jetbrains-mono fonts-font-awesome)
  install(FILES /usr/share/doc/${font}/copyright
    DESTINATION ${licences} RENAME ${font}.txt COMPONENT fonts EXCLUDE_FROM_ALL)
endforeach()

if(WIN32)
  install(FILES assets/desktop/open-with.cmd DESTINATION .)
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
