# A Debian package by CPack, in build/: ./peristat package. It is made from two trees, the presets
# package and package-v3: the first for every processor, the second with another libperistat.so for
# processors with AVX2. glibc's loader chooses between them (glibc-hwcaps, from 2.33 on).
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_SOURCE_DIR}/build)
set(CPACK_PACKAGE_CONTACT "The peristat developers <peristat@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "implicit quasi-static peridynamics")
set(CPACK_PACKAGE_DESCRIPTION
    "Finds the equilibrium of peridynamic bodies with the exact sparse tangent, through fracture,
and draws it: 'peristat run CASE'. Cases to begin with are in /usr/share/peristat/cases.")
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_CMAKE_PROJECTS "${PROJECT_BINARY_DIR};${PROJECT_NAME};ALL;/")
if(CMAKE_SYSTEM_PROCESSOR STREQUAL x86_64)
  list(APPEND CPACK_INSTALL_CMAKE_PROJECTS "${PROJECT_BINARY_DIR}-v3;${PROJECT_NAME};ALL;/")
endif()

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR})
# In addition to the libraries' dependencies: OpenBLAS with OpenMP, because they accept any variant;
# mpirun for --ranks; the python3 that the compiled part of its package is for; and munkres, which
# satisfies matplotlib's fonttools: otherwise apt installs SciPy, its pythran and with that a compiler.
set(CPACK_DEBIAN_PACKAGE_DEPENDS
    "libopenblas0-openmp, openmpi-bin, python3 (>= 3.11), python3 (<< 3.12), python3-munkres, python3-numpy, python3-h5py, python3-matplotlib, python3-pil, python3-meshio, python3-netcdf4")

# For fits alone: it brings a compiler with it.
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "python3-scipy")

# Compile the package of Python, and remove what was compiled.
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/cmake/postinst ${PROJECT_SOURCE_DIR}/cmake/prerm)

# Debian's format of the licence, with indented paragraphs.
file(READ LICENSE BSD_3_CLAUSE)
string(STRIP "${BSD_3_CLAUSE}" BSD_3_CLAUSE)
string(REPLACE "\n\n" "\n.\n" BSD_3_CLAUSE "${BSD_3_CLAUSE}")
string(REPLACE "\n" "\n " BSD_3_CLAUSE "${BSD_3_CLAUSE}")
configure_file(cmake/copyright.in copyright @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/copyright TYPE DOC)

include(CPack)
