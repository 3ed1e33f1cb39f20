# Fails if an object compiled for a special instruction set defines a function that other objects may define too, a weak
# symbol: the linker keeps one copy for all, which then may need instructions that the CPU lacks.
#
# -DNM=<nm> -DOBJECTS=<objects of the library>
set(found 0)
foreach(object IN LISTS OBJECTS)
  if(NOT object MATCHES "(mean_value|qp3|star_planes)_(sse2|avx2|avx512)\\.cpp")
    continue()
  endif()
  math(EXPR found "${found} + 1")
  execute_process(COMMAND ${NM} -C --defined-only ${object} OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX MATCHALL "[^\n]* [WuV] [^\n]*" weak "${symbols}")
  # A pointer to the personality routine, the same whoever defines it.
  list(FILTER weak EXCLUDE REGEX "DW\\.ref\\.__gxx_personality_v0")
  if(weak)
    message(SEND_ERROR "${object} defines weak symbols: ${weak}")
  endif()
endforeach()
if(NOT found EQUAL 9)
  message(SEND_ERROR "Nine kernels expected, ${found} found")
endif()
