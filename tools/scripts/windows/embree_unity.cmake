
# Added to Embree by tools/scripts/windows/build: a unity build of each library. Sources are left out that would define a
# name twice or include a source that another one includes.
foreach(library embree embree_avx embree_avx2 embree_avx512)
  if(TARGET ${library})
    get_target_property(sources ${library} SOURCES)
    list(FILTER sources INCLUDE REGEX "bvh_intersector|bvh[48]_factory|rtcore")
    set_source_files_properties(${sources} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    set_target_properties(${library} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 0)
  endif()
endforeach()
