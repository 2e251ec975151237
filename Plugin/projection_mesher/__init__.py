# SPDX-License-Identifier: BSD-3-Clause
"""The filters of ProjectionMesher for pvpython and for any Python with the same VTK.

    from projection_mesher import vtkProjectionMesh
    mesh = vtkProjectionMesh()
"""
import vtkmodules.vtkCommonExecutionModel  # noqa: F401  (the classes below derive from VTK's)
import vtkmodules.vtkIOCore  # noqa: F401

from .ProjectionMesherFilters import *  # noqa: F401,F403
