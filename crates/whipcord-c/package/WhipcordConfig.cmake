# Targets Whipcord::whipcord, the shared library, and Whipcord::static. The folder may be moved as a whole.
get_filename_component(_whipcord_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)

if(NOT TARGET Whipcord::whipcord)
  add_library(Whipcord::whipcord SHARED IMPORTED)
  set_target_properties(Whipcord::whipcord PROPERTIES
    IMPORTED_LOCATION "${_whipcord_prefix}/lib/libwhipcord.so"
    IMPORTED_SONAME "libwhipcord.so.1"
    INTERFACE_INCLUDE_DIRECTORIES "${_whipcord_prefix}/include")
  add_library(Whipcord::static STATIC IMPORTED)
  set_target_properties(Whipcord::static PROPERTIES
    IMPORTED_LOCATION "${_whipcord_prefix}/lib/libwhipcord.a"
    INTERFACE_LINK_LIBRARIES "pthread;dl;m"
    INTERFACE_INCLUDE_DIRECTORIES "${_whipcord_prefix}/include")
endif()

unset(_whipcord_prefix)
