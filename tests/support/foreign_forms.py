"""Whose particles are read, and how they write them: the rows of the table in ``assets/judge.md``, and other forms."""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from tests.support.foreign_files import (
    PLAIN,
    STRESS,
    Text,
    ample,
    anura3d,
    arrays_apart,
    cb_geo,
    collection,
    comma,
    fortran,
    geotaichi,
    hdf5,
    kratos,
    parallel,
    quoted,
    ranks,
    restart,
    same,
    stacked,
    vtk,
)

KARAMELO = ("ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n64\nITEM: BOX BOUNDS sm sm sm\n0 1.2\n0 1.2\n0 0\n"
            "ITEM: ATOMS {names} \n")
PARAVIEW = {"Point ID": "row", "Points:0": "x", "Points:1": "y", "Points:2": "z", "velocity:0": "vx",
            "velocity:1": "vy", "velocity:2": "vz", "velocity:Magnitude": "0", "id": "id",
            **{f"stress:{k}": name for k, name in enumerate(("sxx", "sxy", "0", "syx", "syy", "0", "0", "0", "szz"))}}


@dataclass(frozen=True)
class Form:
    """Form of particles: ``how`` it is for a reader of the documentation, and its writer; files without ``times``."""

    how: str
    write: Callable[[Path], list[Path]]
    times: bool = True


#: By whose it is.
FORMS: dict[str, Form] = {
    "GeoTaichi": Form("`.npz` with `t_current`, `particleID`, `position` in three directions, `stress` of six",
                      geotaichi),
    "Karamelo": Form("dumps with `ITEM: ATOMS id type tag x y z x0 y0 z0 ... s11 s22 ...`; times by `--time`",
                     Text({"id": "id", "type": "row", "tag": "id", **same("x", "y", "z"), "x0": "X", "y0": "Y",
                           "z0": "Z", **same("vx", "vy", "vz"), "s11": "sxx", "s22": "syy", "s33": "szz",
                           "s12": "sxy", "s13": "0", "s23": "0", "T": "0"}, " ", "", KARAMELO,
                          row=lambda line: f"{line} ", ending=".dat", start=1), False),
    "Kratos": Form("`.vtu` with `MP_VELOCITY`, `MP_DISPLACEMENT`, `MP_CAUCHY_STRESS_VECTOR`: X is x minus the "
                   "displacement", kratos),
    "CB-Geo": Form("`.vtp` with `velocities`, `stresses` of six, `displacements`, `id`", cb_geo),
    "CB-Geo, HDF5": Form("`.h5` with a table of `coord_x`, `velocity_x`, `stress_xx`, `tau_xy`; needs h5py",
                         hdf5),
    "AMPLE": Form("`.vtk` with `sigma_xx`, `u_x`; times by `--time`", ample, False),
    "Anura3D": Form("`.vtk`, three for each moment: `material_point_id`, `velocity_solid`, `total_stress_solid`",
                    anura3d),
    "ParaView": Form('its spreadsheet: `"Points:0"`, `"velocity:0"`, `"stress:0"` to `"stress:8"`',
                     Text(PARAVIEW, heading='"{names}"\n'.replace("{names}", '","'.join(PARAVIEW)))),
    "ParaView, collection": Form("`.pvd` with the times of its `.vtu`", collection),
    "several processes": Form("`.pvtu` and `.pvtp` with their pieces, or a file of each with its own ids", parallel),
    "MATLAB": Form("`%` before the names, blanks between, `x(1)` for a component",
                   Text({"id": "id", "x(1)": "x", "x(2)": "y", "v(1)": "vx", "v(2)": "vy"}, "  ", "% t = {t}\n",
                        "% {names}\n", ending=".txt", start=1)),
    "Julia": Form("tabs between, `x1`, `x2`, `σ11`",
                  Text({"id": "id", "x1": "x", "x2": "y", "v1": "vx", "v2": "vy", "σ11": "sxx", "σ22": "syy",
                        "σ12": "sxy"}, "\t", "# time: {t} s\n", ending=".tsv", start=1)),
    "Fortran": Form("`1.0D-03`, and `1.0-103`",
                    Text(PLAIN | STRESS | {"vz": "0"}, " ", "! Time = {t}\n", "! {names}\n", number=fortran,
                         ending=".dat")),
    "numpy.savetxt": Form("`# id,x,y` above the numbers", Text(PLAIN, heading="# {names}\n")),
    "pandas": Form("an index without a name; texts in columns that are not needed",
                   Text({"": "row", **PLAIN, "material": "steel", "note": "empty"})),
    "R": Form("quoted names, one less than columns",
              Text({f'"{name}"': column for name, column in PLAIN.items()}, " ", row=lambda line: f'"1" {line}')),
    "Excel": Form("`;` or tabs between, decimal comma, `sep=;`, UTF-16",
                  Text(PLAIN, "\t", "Time\t{t}\t\t\t\n", number=comma, ending=".txt", encoding="utf-16")),
}
IDS = ("id ID particle_id particleID material_point_id tag ptag mpid MP_ID p.particleID GlobalParticleId pid "
       "vtkOriginalPointIds").split()


def named(text: str, *columns: str, more: Sequence[str] = ("id",)) -> Text:
    """The names, with | between, of columns, and ``more`` under their own names."""
    return Text({**same(*more), **dict(zip(text.split("|"), columns, strict=True))})


XYV = ("x", "y", "vx", "vy")
#: Names and forms of text that no one owns.
OTHERS: dict[str, Callable[[Path], list[Path]]] = {
    "positions of points twice": lambda folder: vtk(folder, ".vtu", lambda c: {
        "id": c["id"], "velocity": stacked(c, "vx", "vy", "vz"), "MP_COORD": stacked(c, "x", "y", "z")}),
    **{f"rows in any order with {name}": Text({name: "id", **same(*XYV)}, permuted=True) for name in IDS},
    "velocity_0": named("x|y|velocity_0|velocity_1", *XYV), "velocity_1": named("x|y|velocity_1|velocity_2", *XYV),
    "x0 x1 x2": named("x0|x1|x2|v0|v1|v2", "x", "y", "z", "vx", "vy", "vz"),
    "x_1 x_2": named("x_1|x_2|v_1|v_2", *XYV), "pos_x": named("pos_x|pos_y|vel_x|vel_y", *XYV),
    "p.x": named("p.x|p.y|p.v.x|p.v.y", *XYV), "xp": named("xp|yp|vx|vy", *XYV),
    "x_velocity": named("x|y|x_velocity|y_velocity", *XYV),
    "coordinates_X": named("Coordinates_X|Coordinates_Y|V:0|V:1", *XYV),
    "units": named("x [m]|y (m)|vx [m/s]|vy / m/s", *XYV),
    "units at the end": named("x_m|y_m|vx_m/s|vy_m_per_s", *XYV),
    "large letters": Text({name.upper(): column for name, column in PLAIN.items()}),
    "large letters with units": Text({"ID": "id", "X [m]": "x", "Y [m]": "y", "VX [m/s]": "vx", "VY [m/s]": "vy"}),
    "reference and displacement": named("X|Y|ux|uy|vx|vy", "X", "Y", "ux", "uy", "vx", "vy", more=()),
    "displacement": named("x|y|u_1|u_2|vx|vy", "x", "y", "ux", "uy", "vx", "vy", more=()),
    "material position": named("x|y|x0|y0|vx|vy", "x", "y", "X", "Y", "vx", "vy", more=()),
    **{name: named(f"x|y|{names}", "x", "y", *columns.split()) for name, names, columns in (
        ("stress of three", "stress_0|stress_1|stress_2", "sxx syy sxy"),
        ("stress of four row by row", "stress:0|stress:1|stress:2|stress:3", "sxx sxy syx syy"),
        ("stress of four with zz", "stress_1|stress_2|stress_3|stress_4", "sxx syy szz sxy"),
        ("stress of six", "Stress_0|Stress_1|Stress_2|Stress_3|Stress_4|Stress_5", "sxx syy szz sxy 0 0"),
        ("stress of six from 1", "sigma1|sigma2|sigma3|sigma4|sigma5|sigma6", "sxx syy szz sxy 0 0"),
        ("stress by letters", "sigma_x|sigma_y|tau_xy", "sxx syy sxy"),
        ("stress by pairs from 0", "s00|s11|s01", "sxx syy sxy"),
        ("F from 1", "F11|F12|F21|F22", "Fxx Fxy Fyx Fyy"),
        ("F in brackets", "F[0][0]|F[0][1]|F[1][0]|F[1][1]", "Fxx Fxy Fyx Fyy"))},
    "heading without blank": Text(PLAIN, heading="#{names}\n"), "heading with %": Text(PLAIN, heading="%{names}\n"),
    "heading with commas above blanks": Text(PLAIN, " ", heading="# id, x, y, vx, vy\n"),
    "decimal comma": Text(PLAIN, ";", number=comma),
    "decimal comma after tabs": Text(PLAIN, "\t", number=comma, ending=".dat"),
    "decimal comma in quotes": Text(PLAIN, ";", heading="id,x,y,vx,vy\n", number=comma,
                                    row=lambda line: quoted(line, ";")),
    "equal numbers as Fortran writes them": Text(PLAIN | {"z": "0", "vz": "0"}, " ", ending=".dat",
                                                 row=lambda line: re.sub("0 0$", "2*0.0", line)),
    "equal numbers between commas": Text(PLAIN | {"z": "0", "vz": "0"}, row=lambda line: line[:-3] + "2*0.0"),
    "arrays as pandas writes them": Text(PLAIN, " ", heading="id,position [m],velocity\n",
                                         row=lambda line: '{},"[{}, {}]","[{}, {}]"'.format(*line.split())),
    "arrays as numpy writes them": Text(PLAIN, heading="id,material,x,v\n",
                                        row=lambda line: '{},"steel, old",[{} {}],[{} {}]'.format(*line.split(","))),
    "sep=": Text(PLAIN, ";", "sep=;\n# t = {t}\n", number=comma), "quotes": Text(PLAIN, row=quoted),
    "comma at the end": Text(PLAIN, heading="{names},\n", row=lambda line: f"{line},"),
    "comma at the end of rows": Text(PLAIN, row=lambda line: f"{line},"),
    "text and nothing": Text({"material": "steel", **PLAIN, "colour": "empty"}),
    "a tag of bodies": named("tag|x|y|X|Y|vx|vy", "0", "x", "y", "X", "Y", "vx", "vy", more=()),
    "text in columns with known names": Text({"label": "steel", "mass": "empty", **PLAIN, "volume": "steel"}),
    "a comma in quotes": Text({"name": "steel", **PLAIN}, row=lambda line: '"steel, old"' + line[5:]),
    "latin-1": Text({**PLAIN, "T [°C]": "0"}, encoding="latin-1"), "UTF-16": Text(PLAIN, encoding="utf-16"),
    "UTF-16 without mark": Text(PLAIN, encoding="utf-16-le"), "byte order mark": Text(PLAIN, encoding="utf-8-sig"),
    "time above names": Text(PLAIN, above="Time = {t}\n"),
    "time beside others": Text(PLAIN, above="# step 7, time = {t} s\n"),
    "times of other things": Text(PLAIN, above="# wall time: 12 s\n# end time = 2\n# dt = 0.1\n# t = {t}\n"),
    "time with its unit": Text(PLAIN, above="# a run\n# time [s] = {t}\n#\n"),
    "moments below each other": Text(PLAIN, one_file=True),
    "blocks with a comment": Text(PLAIN, " ", "\n\n# Time {t}\n", "# {names}\n", ending=".txt", one_file=True),
    "units below the names": Text(PLAIN, heading="{names}\n-,m,m,m/s,m/s\n"),
    "what the columns are": Text(PLAIN, " ", heading="# Columns: {names}\n"),
    "material points and displacement": named("x|y|ux|uy|vx|vy", "X", "Y", "ux", "uy", "vx", "vy", more=()),
    "remark at the end of lines": Text(PLAIN, " ", row=lambda line: f"{line} # sound"),
    "packed": Text(PLAIN, ending=".csv.gz"), "ids from 1": Text(PLAIN, start=1), "processes": ranks,
    "processes without ids": lambda folder: ranks(folder, "x", "y", "X", "Y", "vx", "vy"),
    "arrays apart": arrays_apart, "a restart": restart,
    ".pvtp": functools.partial(parallel, kind="PolyData", ending=".vtp")}
