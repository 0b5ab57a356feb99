# The single header, and beside it forwarding headers at the paths of the others: what includes any of them gets that one.
set(mica_include ${PROJECT_BINARY_DIR}/single/include)
file(GLOB_RECURSE headers RELATIVE ${PROJECT_SOURCE_DIR}/include CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/include/*.hpp)
foreach(header ${headers})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS include/${header})
    if(header MATCHES "^mica/reference/") # not in it
        configure_file(include/${header} ${mica_include}/${header} COPYONLY)
    elseif(NOT header STREQUAL mica/mica.hpp)
        file(CONFIGURE OUTPUT ${mica_include}/${header} CONTENT "#include <mica/mica.hpp>\n")
    endif()
endforeach()
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS tools/single_header)
execute_process(COMMAND tools/single_header ${mica_include}/mica/mica.hpp
                WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} COMMAND_ERROR_IS_FATAL ANY)
