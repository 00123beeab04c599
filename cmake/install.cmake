# The library libperistat.so of everything below commands and results, and the installation: the library with its
# headers and its CMake package, the modules, the program, the launcher with its Python scripts, cases
# and documentation.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# Users of the library link nothing else: other libraries are private to it.
add_library(peristat_library SHARED
  $<TARGET_OBJECTS:peristat_mechanics>
  $<TARGET_OBJECTS:peristat_assembly>
  $<TARGET_OBJECTS:peristat_solvers>
  $<TARGET_OBJECTS:peristat_cases>)
add_library(peristat::peristat ALIAS peristat_library)
set_target_properties(peristat_library PROPERTIES
  OUTPUT_NAME peristat EXPORT_NAME peristat LINKER_LANGUAGE CXX
  VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
target_compile_features(peristat_library INTERFACE cxx_std_20)
target_include_directories(peristat_library INTERFACE
  $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
target_link_libraries(peristat_library
  PRIVATE peristat_cholmod peristat_muparser peristat_voropp peristat_fftw peristat_cgal fmt::fmt ${CMAKE_DL_LIBS}
  PUBLIC OpenMP::OpenMP_CXX)

# The library calls its own functions even if a program has a weak function of the same name, possibly
# compiled for another processor level.
target_link_options(peristat_library PRIVATE LINKER:-Bsymbolic-functions)

# Paths to the library, the modules, and the OpenMP variant of OpenBLAS.
set(module_folder ${CMAKE_INSTALL_LIBDIR}/peristat)
set(program_folder libexec/peristat)  # known to the launcher
# Debian's python3 finds the package below the prefix /usr; the launcher of another prefix sets PYTHONPATH.
set(python_folder lib/python3/dist-packages/peristat)  # known to the launcher
if(SKBUILD)  # a wheel has the package alone, with the modules in it (pyproject.toml)
  set(python_folder peristat)
  set(module_folder peristat)
endif()
file(RELATIVE_PATH libraries_from_program /${program_folder} /${CMAKE_INSTALL_LIBDIR})
set_target_properties(peristat_library PROPERTIES
  INSTALL_RPATH "$ORIGIN/peristat" INSTALL_RPATH_USE_LINK_PATH ON)
set_target_properties(peristat PROPERTIES
  INSTALL_RPATH "$ORIGIN/${libraries_from_program};$ORIGIN/${libraries_from_program}/peristat"
  INSTALL_RPATH_USE_LINK_PATH ON)

if(PERISTAT_LEVEL)
  # Only the library, in the folder that glibc's loader searches first on such processors.
  set_property(TARGET peristat_library PROPERTY INSTALL_RPATH "$ORIGIN/../../peristat")
  install(TARGETS peristat_library
          LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/glibc-hwcaps/${PERISTAT_LEVEL} NAMELINK_SKIP)
  return()
endif()

# bin/peristat is the launcher: it finds ../libexec/peristat/peristat and ../share/peristat.
install(PROGRAMS peristat TYPE BIN)
install(TARGETS peristat RUNTIME DESTINATION ${program_folder})
set(tools_folder share/peristat)
foreach(tool IN ITEMS sweep fit trust meshes)
  install(DIRECTORY cases/runner/${tool} DESTINATION ${tools_folder} FILES_MATCHING PATTERN *.py)
endforeach()
install(DIRECTORY python/peristat/ DESTINATION ${python_folder}
        FILES_MATCHING PATTERN *.py PATTERN *.pyi PATTERN py.typed PATTERN __pycache__ EXCLUDE)
if(TARGET peristat_python)
  file(RELATIVE_PATH libraries_from_python /${python_folder} /${CMAKE_INSTALL_LIBDIR})
  file(RELATIVE_PATH modules_from_python /${python_folder} /${module_folder})
  set_target_properties(peristat_python PROPERTIES
    INSTALL_RPATH "$ORIGIN/${modules_from_python};$ORIGIN/${libraries_from_python}"
    INSTALL_RPATH_USE_LINK_PATH ON)
  install(TARGETS peristat_python LIBRARY DESTINATION ${python_folder} COMPONENT python)
endif()
# The program of the pages is built by the launcher, which needs npm: ./peristat report, ./peristat package.
set(report_program ${PROJECT_SOURCE_DIR}/build/report)
foreach(file IN ITEMS main.js loader.js main.css licences.txt)
  install(FILES ${report_program}/${file} DESTINATION ${python_folder}/report/program OPTIONAL)
endforeach()
install(DIRECTORY cases DESTINATION ${tools_folder} PATTERN runner EXCLUDE)
install(FILES docs/case.schema.json DESTINATION ${tools_folder}/docs)  # where the cases look for it
install(DIRECTORY docs TYPE DOC PATTERN site EXCLUDE)
install(FILES README.md CHANGELOG.md CONTRIBUTING.md LICENSE TYPE DOC)
install(FILES benchmarks/RESULTS.md DESTINATION ${CMAKE_INSTALL_DOCDIR}/benchmarks)

install(TARGETS peristat_trilinos peristat_ranks peristat_mumps
        LIBRARY DESTINATION ${module_folder} COMPONENT python)
install(TARGETS peristat_library EXPORT peristatTargets LIBRARY)
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/peristat)
install(EXPORT peristatTargets NAMESPACE peristat:: DESTINATION ${package_folder})
configure_package_config_file(cmake/peristatConfig.cmake.in peristatConfig.cmake
                              INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(peristatConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/peristatConfig.cmake
              ${PROJECT_BINARY_DIR}/peristatConfigVersion.cmake
        DESTINATION ${package_folder})
install(CODE "set(SOURCE \"${PROJECT_SOURCE_DIR}\")
set(STAGE \"${PROJECT_BINARY_DIR}/installed_headers/peristat\")
include(\"${PROJECT_SOURCE_DIR}/cmake/stage_headers.cmake\")")
install(DIRECTORY ${PROJECT_BINARY_DIR}/installed_headers/peristat
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
