# Checked builds. A finding ends the program, so a test that meets one fails.
if(SPHBENCH_FUZZ AND NOT CMAKE_C_COMPILER_ID MATCHES "Clang")
  message(FATAL_ERROR "SPHBENCH_FUZZ needs clang, found ${CMAKE_C_COMPILER_ID}: "
                      "configure with -DCMAKE_C_COMPILER=clang")
endif()
if(SPHBENCH_SANITIZE OR SPHBENCH_FUZZ)
  set(sanitizers -fsanitize=address,undefined)
  add_compile_options(${sanitizers} -fno-sanitize-recover=all -fno-omit-frame-pointer -g)
  add_link_options(${sanitizers})
endif()
if(SPHBENCH_FUZZ)
  add_compile_options(-fsanitize=fuzzer-no-link)
endif()
