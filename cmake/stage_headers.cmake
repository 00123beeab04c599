# Copies the headers of SOURCE to STAGE, from where they are installed as include/peristat. Includes
# relative to the root of the sources ("src/geometry/points.hpp") get that folder as a prefix
# ("peristat/src/geometry/points.hpp"), so that a program with its own src/ still includes ours.
file(REMOVE_RECURSE "${STAGE}")
file(GLOB_RECURSE headers RELATIVE "${SOURCE}"
     "${SOURCE}/src/*.hpp" "${SOURCE}/assembly/*.hpp" "${SOURCE}/solvers/*.hpp"
     "${SOURCE}/cases/runner/input/*.hpp" "${SOURCE}/cases/runner/setup/*.hpp")
foreach(header IN LISTS headers)
  file(READ "${SOURCE}/${header}" text)
  string(REGEX REPLACE "#include \"(src|assembly|solvers|cases)/" "#include \"peristat/\\1/"
         text "${text}")
  file(WRITE "${STAGE}/${header}" "${text}")
endforeach()
file(RENAME "${STAGE}/cases/runner/setup/peristat.hpp" "${STAGE}/peristat.hpp")
