# Copies the headers of SOURCE to STAGE, from where they are installed as include/peristat. Includes
# that start at the root of the sources ("src/geometry/points.hpp") start at that folder there
# ("peristat/src/geometry/points.hpp"): a program that has a src/ of its own gets ours.
file(REMOVE_RECURSE "${STAGE}")
file(GLOB_RECURSE headers RELATIVE "${SOURCE}"
     "${SOURCE}/src/*.hpp" "${SOURCE}/assembly/*.hpp" "${SOURCE}/solvers/*.hpp")
foreach(header IN LISTS headers)
  file(READ "${SOURCE}/${header}" text)
  string(REGEX REPLACE "#include \"(src|assembly|solvers)/" "#include \"peristat/\\1/"
         text "${text}")
  file(WRITE "${STAGE}/${header}" "${text}")
endforeach()
file(RENAME "${STAGE}/solvers/study/peristat.hpp" "${STAGE}/peristat.hpp")
