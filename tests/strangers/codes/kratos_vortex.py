"""The generalized vortex by KratosMPMApplication, as ``listed.py`` says:  kratos_vortex.py PROBLEM_DIR OUT.npz"""

import importlib.metadata
import json
import os
import sys
import tempfile
from pathlib import Path

import KratosMultiphysics as kratos
import KratosMultiphysics.MPMApplication as mpm
import numpy as np
from handout import Vortex
from KratosMultiphysics.MPMApplication.mpm_analysis import MpmAnalysis

SETTINGS = {"problem_data": {"problem_name": "vortex", "parallel_type": "OpenMP", "start_time": 0.0, "echo_level": 0},
            "solver_settings": {
                "solver_type": "dynamic", "time_integration_method": "implicit", "scheme_type": "newmark",
                "domain_size": 2, "model_part_name": "MPM_Material", "convergence_criterion": "residual_criterion",
                "residual_relative_tolerance": 1e-8,
                "material_import_settings": {"materials_filename": "materials.json"},
                "model_import_settings": {"input_type": "mdpa", "input_filename": "body"},
                "grid_model_import_settings": {"input_type": "mdpa", "input_filename": "grid"}},
            "processes": {}, "output_processes": {}}


def mesh(name, element, corners, fours):
    """Write an .mdpa with these nodes (N, 2) and elements (M, 4), the body's in the part "Parts"."""
    nodes = [f"{i + 1} {x!r} {y!r} 0" for i, (x, y) in enumerate(corners.tolist())]
    elements = [f"{i + 1} 0 " + " ".join(str(k + 1) for k in four) for i, four in enumerate(fours.tolist())]
    blocks = [("Properties 0", []), ("Nodes", nodes), (f"Elements {element}", elements)]
    part = [("SubModelPartNodes", range(1, len(nodes) + 1)), ("SubModelPartElements", range(1, len(elements) + 1))]
    written = ["\n".join([f"Begin {head}", *map(str, rows), f"End {head.split()[0]}"]) for head, rows in blocks + part]
    Path(name).write_text("\n".join([*written[:3], "Begin SubModelPart Parts", *written[3:], "End SubModelPart\n"]))


def main(problem, out):
    ring = Vortex(problem, cfl=0.2)
    h, n = ring.h, ring.cells + 1
    os.chdir(tempfile.mkdtemp())
    square = h / ring.ppc / 4 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])  # around each particle
    lower = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    places = np.stack(np.meshgrid(np.arange(n) * h - 1.5, np.arange(n) * h - 1.5, indexing="ij"), axis=-1)
    cells = np.stack([lower, lower + n, lower + n + 1, lower + 1], axis=1)
    mesh("grid.mdpa", "Element2D4N", places.reshape(-1, 2), cells)
    mesh("body.mdpa", "MPMUpdatedLagrangian2D4N", (ring.X[:, None] + square).reshape(-1, 2),
         np.arange(4 * ring.particles).reshape(-1, 4))
    law = {"constitutive_law": {"name": "HyperElasticNeoHookeanPlaneStrain2DLaw"}, "Tables": {}, "Variables": {
        "THICKNESS": 1.0, "MATERIAL_POINTS_PER_ELEMENT": 1, "DENSITY": ring.density, "YOUNG_MODULUS": ring.modulus,
        "POISSON_RATIO": ring.ratio}}
    Path("materials.json").write_text(json.dumps({"properties": [
        {"model_part_name": "Initial_MPM_Material.Parts", "properties_id": 1, "Material": law}]}))
    SETTINGS["problem_data"]["end_time"] = ring.steps * ring.dt
    SETTINGS["solver_settings"]["time_stepping"] = {"time_step": ring.dt}
    model = kratos.Model()
    run = MpmAnalysis(model, kratos.Parameters(json.dumps(SETTINGS)))
    run.Initialize()
    points, info = list(model["MPM_Material"].Elements), model["MPM_Material"].ProcessInfo

    def give(variable, values):
        for point, value in zip(points, values):  # noqa: B905
            numbers = kratos.Array3([*value, 0.0]) if np.ndim(value) else float(value)
            point.SetValuesOnIntegrationPoints(variable, [numbers], info)

    def ask(variable):
        return np.array([point.CalculateOnIntegrationPoints(variable, info)[0] for point in points])

    for variable, values in ((mpm.MP_VELOCITY, ring.v), (mpm.MP_ACCELERATION, ring.push(0)),
                             (mpm.MP_VOLUME, ring.start["volume"]), (mpm.MP_MASS, ring.start["mass"])):
        give(variable, values)
    for step in range(ring.steps + 1):
        if ring.looks(step):
            ring.keep(step, x=ask(mpm.MP_COORD)[:, :2], v=ask(mpm.MP_VELOCITY)[:, :2],
                      sigma=ask(mpm.MP_CAUCHY_STRESS_VECTOR)[:, [0, 2, 2, 1]])
        give(mpm.MP_VOLUME_ACCELERATION, ring.push(step + 1))
        run.time = run._AdvanceTime()
        run.InitializeSolutionStep()
        run._GetSolver().Predict()
        run._GetSolver().SolveSolutionStep()
        run.FinalizeSolutionStep()
    ring.finish(out, version=importlib.metadata.version("KratosMPMApplication"))


if __name__ == "__main__":
    main(*map(os.path.abspath, sys.argv[1:]))
