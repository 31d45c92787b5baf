"""What a visitor sees first who has followed no link: what goes wrong, where it does.

Hat functions beside B-splines, slowly, for the quarter of a period in which the first particles change their cell: the
stress is wrong where they have just done so. At larger amplitudes, where all of them cross again and again, those that
crossed err no more than the others, and such a picture would say what is not so.
"""

from app import state

#: It stops after the quarter.
OPENING = state.read("bar;method=mpm;amplitude=0.0034;periods=0.25;estimators=recovered,transport;error-of=sigma;"
                     "speed=0.0125;stops;"
                     "pinned;method=bspline;amplitude=0.0034;periods=0.25;estimators=recovered,transport")
