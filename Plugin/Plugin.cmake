# SPDX-License-Identifier: BSD-3-Clause
# ParaView, the VTK module with its Python wrapping, and the plugin. Included from the top level.
include(GNUInstallDirs)
enable_language(C)
find_package(MPI COMPONENTS C)  # named by ParaView's own targets where it was built with MPI
find_package(ParaView REQUIRED COMPONENTS RemotingCore RemotingServerManager)

set(BUILD_SHARED_LIBS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/${CMAKE_INSTALL_BINDIR})
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/${CMAKE_INSTALL_LIBDIR})
set(CMAKE_ARCHIVE_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/${CMAKE_INSTALL_LIBDIR})

# The module; its classes can be imported in Python from projection_mesher.
vtk_module_scan(
  MODULE_FILES ${PROJECT_SOURCE_DIR}/Filters/vtk.module
  PROVIDES_MODULES module
  REQUIRES_MODULES required_modules
  WANT_BY_DEFAULT ON
  HIDE_MODULES_FROM_CACHE ON)
vtk_module_build(
  MODULES ${module}
  PACKAGE ProjectionMesher
  INSTALL_HEADERS OFF
  ENABLE_WRAPPING ON)
if(PARAVIEW_USE_PYTHON)
  find_package(Python3 REQUIRED COMPONENTS Interpreter Development)
  set(PROJECTIONMESHER_PYTHON_DIR ${CMAKE_INSTALL_LIBDIR}/python3/dist-packages)
  set(package projection_mesher)
  set(CMAKE_INSTALL_RPATH "\$ORIGIN/../../..")
  vtk_module_wrap_python(
    MODULES ${module}
    TARGET ProjectionMesher::Python
    PYTHON_PACKAGE ${package}
    MODULE_DESTINATION ${PROJECTIONMESHER_PYTHON_DIR}
    INSTALL_HEADERS OFF)
  unset(CMAKE_INSTALL_RPATH)
  configure_file(${PROJECT_SOURCE_DIR}/Plugin/${package}/__init__.py
    ${CMAKE_BINARY_DIR}/${PROJECTIONMESHER_PYTHON_DIR}/${package}/__init__.py COPYONLY)
  install(FILES ${PROJECT_SOURCE_DIR}/Plugin/${package}/__init__.py
    DESTINATION ${PROJECTIONMESHER_PYTHON_DIR}/${package})
endif()

paraview_plugin_scan(
  PLUGIN_FILES ${PROJECT_SOURCE_DIR}/Plugin/paraview.plugin
  PROVIDES_PLUGINS plugins
  REQUIRES_MODULES plugin_modules
  ENABLE_BY_DEFAULT ON
  HIDE_PLUGINS_FROM_CACHE ON)
paraview_plugin_build(
  PLUGINS ${plugins}
  PLUGINS_FILE_NAME projectionmesher.xml
  LIBRARY_SUBDIRECTORY paraview/plugins)
