"""Which codes are judged, and with what. What is said of each beside its numbers stands in ``said/``."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

SAID = Path(__file__).parent / "said"


@dataclass(frozen=True)
class Stranger:
    """A code of others, and the problem that it is given.

    ``script`` is the name of its file in ``codes/`` and of its text in ``said/``; ``install`` are the packages that its
    environment gets, with their versions, on a Python of the version ``python``; ``flags`` say the problem to both
    ``mpm-lab problem`` and ``mpm-lab judge``, ``grids`` the cells. ``kin`` is the method of ours that is nearest to it.
    """

    script: str
    install: tuple[str, ...]
    python: str
    problem: str
    flags: tuple[str, ...]
    grids: tuple[int, ...]
    precision: str
    kin: str

    @property
    def package(self) -> str:
        """The package and its version, as one types it."""
        return self.install[0]

    def said(self) -> tuple[str, str, str]:
        """What it was made for, how it was set up here, and what was learned: the paragraphs of its text."""
        text = (SAID / f"{self.script}.md").read_text(encoding="utf-8")
        made_for, here, learned = (" ".join(part.partition(":")[2].split()) for part in text.split("\n\n"))
        return made_for, here, learned


LARGE = ("--periods", "1")
SMALL = ("--ppc", "2", "--amplitude", "0.00025", "--periods")

STRANGERS = (
    Stranger("taichi_mpm99_bar", ("taichi==1.7.4",), "3.11", "bar",
             LARGE, (10, 20, 40), "double", "bspline"),
    Stranger("taichi_elements_bar", ("taichi-elements==0.0.1", "taichi==0.7.21"), "3.8", "bar",
             LARGE, (10, 20, 40), "single", "bspline"),
    Stranger("genesis_bar", ("genesis-world==1.4.5", "torch==2.15.0"), "3.11", "bar",
             LARGE, (10, 20, 40), "double", "bspline"),
    Stranger("mpm_pytorch_bar", ("mpm-pytorch==0.1.1", "torch==2.15.0"), "3.11", "bar",
             LARGE, (10, 20, 40), "double", "bspline"),
    Stranger("geotaichi_bar", ("geotaichi==0.2.6",), "3.10", "bar",
             (*SMALL, "1"), (10, 20, 40), "double", "ugimp"),
    Stranger("newton_bar", ("newton==1.8.0", "warp-lang==1.19.0"), "3.11", "bar",
             (*SMALL, "0.5"), (10, 20, 40), "single", "mpm"),
    Stranger("kratos_vortex", ("KratosMPMApplication==10.4.4",), "3.11", "vortex",
             ("--amplitude", "0.25"), (24, 36, 48), "double", "mpm"),
    Stranger("genesis_vortex", ("genesis-world==1.4.5", "torch==2.15.0"), "3.11", "vortex",
             ("--amplitude", "0.25", "--poisson-ratio", "0", "--layout", "cartesian", "--ppc", "2"),
             (24, 36, 48), "double", "cpdi"),
)
