# Called after a test program is built: writes a file for CTest with one test
# for each suite of PROGRAM. A process for each of its tests would spend half of
# the time loading libraries.
execute_process(COMMAND ${PROGRAM} --gtest_list_tests
                OUTPUT_VARIABLE list COMMAND_ERROR_IS_FATAL ANY)
# Suites begin a line and end with a dot; values of parameters follow a #.
string(REGEX MATCHALL "(^|\n)[^ \n]+\\." suites "${list}")
set(text "")
foreach(suite ${suites})
  string(STRIP "${suite}" suite)
  string(REGEX REPLACE "\\.$" "" suite "${suite}")
  string(APPEND text "add_test([==[${PREFIX}.${suite}]==] [==[${PROGRAM}]==] "
                     "[==[--gtest_filter=${suite}.*]==])\n"
                     "set_tests_properties([==[${PREFIX}.${suite}]==] PROPERTIES "
                     # Only if all of its tests are: a failure must not be hidden.
                     "SKIP_REGULAR_EXPRESSION "
                     "[==[PASSED  . 0 tests.\n(.  SKIPPED . [^\n]*\n)+$]==])\n")
endforeach()
file(WRITE ${OUTPUT} "${text}")
